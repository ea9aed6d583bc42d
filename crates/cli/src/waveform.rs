//! One period of a solution in time, as CSV with units in the header.

use scene::{Motion, Scene};

use crate::ending::Failure;
use crate::output::Output;

/// Time, displacements of the output dofs, relative displacement and force of every contact.
pub fn write(output: Output, scene: &Scene, motion: &Motion) -> Result<(), Failure> {
    let mut header = vec!["time [s]".to_owned()];
    header.extend(scene.output().iter().map(|dof| format!("{dof} [m]")));
    for name in scene.contacts() {
        header.extend([format!("{name} relative displacement [m]"), format!("{name} force [N]")]);
    }
    let period = &motion.waveform;
    let contacts = period.contacts.iter().flat_map(|contact| [&contact.displacement, &contact.force]);
    let columns: Vec<&Vec<f64>> = period.displacement.iter().chain(contacts).collect();
    output.write(|out| {
        let mut table = csv::Writer::from_writer(out);
        table.write_record(&header)?;
        for (j, time) in motion.time.iter().enumerate() {
            let values = columns.iter().filter_map(|column| column.get(j));
            table.write_record(std::iter::once(time).chain(values).map(|value| format!("{value:e}")))?;
        }
        table.flush()
    })
}
