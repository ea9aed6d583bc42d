//! The JSON Schema of a study, for editors and other checkers.

/// The schema, JSON text, written by hand like [that of a scene](scene::SCHEMA). Tests hold it against the reader's keys,
/// against the definitions it shares with a scene, and against accepted and refused studies.
pub const SCHEMA: &str = include_str!("study.schema.json");

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::SCHEMA;
    use crate::{axis, grid};

    fn schema() -> Value {
        serde_json::from_str(SCHEMA).unwrap()
    }

    #[test]
    fn it_has_the_readers_keys() {
        let schema = schema();
        for (object, keys) in [(&schema, &grid::KEYS[..]), (&schema["$defs"]["values"], &axis::KEYS)] {
            assert_eq!(object["additionalProperties"], false);
            let mut keys: Vec<&str> = [keys, &["$schema", "comment"]].concat();
            keys.sort_unstable();
            let mut found: Vec<&str> =
                object["properties"].as_object().unwrap().keys().map(String::as_str).collect();
            found.sort_unstable();
            assert_eq!(found, keys);
        }
    }

    /// An editor reads one file: what a study shares with a scene is in both.
    #[test]
    fn what_it_shares_with_a_scene_is_the_same() {
        let (study, scene) = (schema(), serde_json::from_str::<Value>(scene::SCHEMA).unwrap());
        for definition in ["remark", "name", "frequencies", "range", "needed_harmonics"] {
            assert!(scene["$defs"][definition].is_object(), "{definition}");
            assert_eq!(study["$defs"][definition], scene["$defs"][definition], "{definition}");
        }
        assert_eq!(study["$defs"]["harmonics"]["oneOf"], scene["properties"]["harmonics"]["oneOf"]);
    }
}
