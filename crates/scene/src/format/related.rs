//! Words of related formats of scenes, for remedies: what is meant by them here.

/// Keys and words of other ray tracers' scenes, in lower case, each with the one here.
const RELATED: [(&str, &str); 20] = [
    ("v0", "points"),
    ("v1", "points"),
    ("v2", "points"),
    ("v3", "points"),
    ("vertices", "points"),
    ("faces", "indices"),
    ("position", "location"),
    ("eye", "location"),
    ("lookat", "look"),
    ("upvector", "up"),
    ("reflectivity", "kr"),
    ("refractiveindex", "ior"),
    ("shininess", "specularexponent"),
    ("diffuse", "diffusecolor"),
    ("lights", "lightsources"),
    ("objects", "shapes"),
    ("cylinder", "trimesh"),
    ("cone", "trimesh"),
    ("box", "trimesh"),
    ("mesh", "trimesh"),
];

/// What a key or a word of another format is called here.
pub(super) fn related(word: &str) -> Option<&'static str> {
    let is_it = |(theirs, _): &&(&str, &str)| theirs.eq_ignore_ascii_case(word);
    RELATED.iter().find(is_it).map(|(_, own)| *own)
}
