//! Words of related formats of scenes, for remedies: what is meant by them here.

/// Keys and words here, each with those of other ray tracers' scenes for it, in lower case.
const RELATED: [(&str, &[&str]); 12] = [
    ("points", &["v0", "v1", "v2", "v3", "vertices"]),
    ("indices", &["faces"]),
    ("location", &["position", "eye"]),
    ("look", &["lookat"]),
    ("up", &["upvector"]),
    ("kr", &["reflectivity"]),
    ("ior", &["refractiveindex"]),
    ("specularexponent", &["shininess"]),
    ("diffusecolor", &["diffuse"]),
    ("lightsources", &["lights"]),
    ("shapes", &["objects"]),
    ("trimesh", &["cylinder", "cone", "box", "mesh"]),
];

/// What a key or a word of another format is called here.
pub(super) fn related(word: &str) -> Option<&'static str> {
    let is_it = |theirs: &&str| theirs.eq_ignore_ascii_case(word);
    RELATED.iter().find(|(_, theirs)| theirs.iter().any(is_it)).map(|(own, _)| *own)
}
