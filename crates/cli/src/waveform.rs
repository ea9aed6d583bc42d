//! One period of a solution in time, as CSV with units in the header.

use scene::{Motion, Scene};

use crate::ending::Failure;
use crate::output::Output;

/// Time, displacements of the output dofs, relative displacement and force of every contact in each of its directions.
pub fn write(output: Output, scene: &Scene, motion: &Motion) -> Result<(), Failure> {
    let mut header = vec!["time [s]".to_owned()];
    header.extend(scene.output().iter().map(|dof| format!("{dof} [m]")));
    let mut columns: Vec<&[f64]> = motion.waveform.displacement.iter().map(Vec::as_slice).collect();
    for contact in scene.contact_motions(&motion.waveform) {
        for direction in contact.directions {
            let name = [contact.name, direction.name].join(" ");
            let name = name.trim_end();
            header.extend([format!("{name} relative displacement [m]"), format!("{name} force [N]")]);
            columns.extend([direction.displacement, direction.force]);
        }
    }
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
