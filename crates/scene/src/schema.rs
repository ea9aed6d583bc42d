//! The JSON Schema of a scene, for editors and other checkers.

/// The schema, JSON text. It is written by hand: the reader speaks of paths and near misses rather than of types, so
/// there is nothing to derive it from. Tests hold it against the reader's keys and against accepted and refused scenes.
pub const SCHEMA: &str = include_str!("scene.schema.json");

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::SCHEMA;
    use crate::{
        axes, contacts, dofs, excitation, frequencies, harmonics, iwan, joint_law, joints, law, loop_family,
        loops, matrix, model, reduction, scene, solver,
    };

    /// Properties of a definition, or of the scene itself, without remarks.
    fn properties(definition: &str) -> Vec<String> {
        let schema: Value = serde_json::from_str(SCHEMA).unwrap();
        let object = if definition.is_empty() { &schema } else { &schema["$defs"][definition] };
        assert_eq!(object["additionalProperties"], false, "{definition}");
        let keys: Vec<String> = object["properties"].as_object().unwrap().keys().cloned().collect();
        assert!(keys.contains(&"comment".into()) && keys.contains(&"$schema".into()), "{definition}");
        keys.into_iter().filter(|key| key != "comment" && key != "$schema").collect()
    }

    #[test]
    fn it_has_the_readers_keys() {
        for (definition, keys) in [
            ("", &scene::KEYS[..]),
            ("model", &model::KEYS),
            ("rayleigh", &model::RAYLEIGH_KEYS),
            ("matrix_market", &matrix::MATRIX_MARKET_KEYS),
            ("npy", &matrix::NPY_KEYS),
            ("npz", &matrix::NPZ_KEYS),
            ("names_file", &dofs::FILE_KEYS),
            ("reduction", &reduction::KEYS),
            ("excitation", &excitation::KEYS),
            ("contact", &contacts::KEYS),
            ("axes", &axes::KEYS),
            ("directions", &joints::DIRECTION_KEYS),
            ("friction_contact", &joint_law::FRICTION_CONTACT_KEYS),
            ("normal_load", &joint_law::NORMAL_LOAD_KEYS),
            ("gap", &law::GAP_KEYS),
            ("scaled_loop", &law::SCALED_LOOP_KEYS),
            ("loop_family", &loop_family::KEYS),
            ("iwan", &iwan::KEYS),
            ("elastic_coulomb", &law::ELASTIC_COULOMB_KEYS),
            ("coulomb", &law::COULOMB_KEYS),
            ("cubic", &law::SPRING_KEYS),
            ("linear", &law::SPRING_KEYS),
            ("magnitude", &law::MAGNITUDE_KEYS),
            ("phase", &law::PHASE_KEYS),
            ("loop", &loops::KEYS),
            ("columns", &loops::QUANTITIES),
            ("units", &loops::QUANTITIES),
            ("range", &frequencies::KEYS),
            ("solver", &solver::KEYS),
            ("needed_harmonics", &harmonics::ADAPTIVE_KEYS),
        ] {
            let mut keys: Vec<String> = keys.iter().map(|key| (*key).to_owned()).collect();
            keys.sort();
            let mut found = properties(definition);
            found.sort();
            assert_eq!(found, keys, "{definition}");
        }
    }

    #[test]
    fn it_has_a_definition_for_every_law() {
        let schema: Value = serde_json::from_str(SCHEMA).unwrap();
        for law in law::LAWS.into_iter().chain(joint_law::LAWS) {
            assert_eq!(schema["$defs"][law]["properties"]["type"]["const"], law);
        }
    }
}
