//! The records of a sweep.

use wavecrest_report::accuracy::store::{SceneRecord, Store, SweepHeader};

#[test]
fn another_scene_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let header = SweepHeader { version: "1".into(), longest: 8, most: 4, least: 16 };
    let mut store = Store::open(folder.path(), &header).unwrap();
    let scene = |fingerprint: &str| SceneRecord {
        scene: "a".into(),
        file: "a.json".into(),
        fingerprint: fingerprint.into(),
        size: [4, 3],
        primitives: 1,
    };
    store.admit(scene("12")).unwrap();
    store.admit(scene("12")).unwrap();
    let changed = store.admit(scene("13")).unwrap_err().to_string();
    assert!(
        changed.starts_with("a.json: the scene differs from the one in the results"),
        "{changed}"
    );
    assert_eq!(store.records.len(), 2);
}
