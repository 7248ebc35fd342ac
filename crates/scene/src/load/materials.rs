//! The materials of an OBJ file from its MTL files, or the images of a PLY file: a shape for each.
//!
//! A missing material gives a warning, and its faces have the material of the shape.

use std::collections::{BTreeSet, HashMap};
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use hecs::EntityBuilder;

use crate::components::{Maps, Mesh, Name, TextureSource};
use crate::folder::{Denied, Folder, last_part};
use crate::format::{Declaration, Notes};
use crate::image_file::Head;
use crate::mesh::{MeshData, NamedMaterials};
use crate::mtl::{Library, Mtl, MtlSurface, surface};
use crate::surface::{MATERIAL, SURFACE};
use wavecrest_base::error::{Error, ErrorKind};

/// Largest MTL file in bytes, 64 MiB.
const LONGEST_FILE: u64 = 1 << 26;

/// Largest number of MTL files.
const MOST_FILES: usize = 64;

/// What is done without an MTL file.
const WITHOUT_FILE: &str = "its faces use the default material";

/// Splits a shape, whose `mesh` was read from `file`: into a shape for each material of its faces, and one for the faces
/// without a known material. `begin` makes one with the whole shape's place, and these components of its surface.
pub(super) fn split(
    begin: impl Fn(&[Declaration]) -> EntityBuilder,
    mesh: MeshData,
    named: &NamedMaterials,
    file: &Path,
    notes: &Notes<'_>,
) -> Vec<EntityBuilder> {
    let folder = Folder::of(file, notes.outside);
    let reader = Reader { file, folder, notes };
    let library = reader.library(named);
    let (part, names) = numbered(named, mesh.triangles.len(), &library);
    reader.warn_of_unknown(named, &library);
    let mut parts = Vec::new();
    for (number, data) in mesh.split(&part, names.len() + 1) {
        let known = (number as usize).checked_sub(1).map(|i| &names[i]);
        // Without coordinates there is no look-up.
        let mut entity = begin(match (known, &data.uvs) {
            (Some(_), _) => &[],
            (None, Some(_)) => &SURFACE,
            (None, None) => &[MATERIAL],
        });
        if let Some(&(name, (mtl, from))) = known {
            let MtlSurface { material, transparency, texture, metal, cutout, is_there } =
                surface(mtl, |image| reader.image(from, image));
            if !is_there {
                let message = format!("faces with the material {name} are left out");
                reader.warn(&message, "its opacity (d) is 0");
                continue;
            }
            let has_uvs = texture.is_none() && cutout.is_none() || reader.has_uvs(&data);
            entity.add(material);
            if transparency.has_effect() {
                entity.add(transparency);
            }
            if let (Some(metal), true) = (metal, has_uvs) {
                let own = entity.get::<&Maps>().cloned().unwrap_or_default();
                entity.add(Maps { metal: Some(metal), ..own });
            }
            texture.filter(|_| has_uvs).map(|texture| entity.add(texture));
            cutout.filter(|_| has_uvs).map(|cutout| entity.add(cutout));
            if let Some(own) = entity.get_mut::<&mut Name>() {
                own.0 = format!("{}-{name}", own.0);
            }
        }
        entity.add(Mesh { data, file: Some(file.to_owned()), ..Mesh::default() });
        parts.push(entity);
    }
    if parts.is_empty() {
        let message = "nothing is left of the mesh: all its materials are invisible";
        reader.warn(message, "set d to 1 in its MTL file, or remove the mtllib statement");
    }
    parts
}

/// A material by its name, and the folder of its file.
type Known<'a> = (&'a str, &'a (Mtl, PathBuf));

/// For each triangle the number of its material, from 1, or 0; and the materials in the order of
/// their use.
fn numbered<'a>(
    named: &'a NamedMaterials,
    triangles: usize,
    library: &'a HashMap<String, (Mtl, PathBuf)>,
) -> (Vec<u32>, Vec<Known<'a>>) {
    let mut part = vec![0; triangles];
    let mut numbers: HashMap<&str, u32> = HashMap::new();
    let mut known = Vec::new();
    let ends = named.runs.iter().skip(1).map(|run| run.0 as usize).chain([triangles]);
    for ((first, name), end) in named.runs.iter().zip(ends) {
        let (Some(material), true) = (library.get(name), (*first as usize) < end) else { continue };
        let number = *numbers.entry(name).or_insert_with(|| {
            known.push((name.as_str(), material));
            known.len() as u32
        });
        part[*first as usize..end].fill(number);
    }
    (part, known)
}

/// Reads the files that a mesh file names.
struct Reader<'a> {
    file: &'a Path,
    folder: Folder,
    notes: &'a Notes<'a>,
}

impl Reader<'_> {
    /// All materials of the existing files and images, by name, each with its file's folder.
    fn library(&self, named: &NamedMaterials) -> HashMap<String, (Mtl, PathBuf)> {
        let mut all = HashMap::new();
        let mut told = Library::default();
        for path in self.libraries(&named.libraries) {
            let Some(text) = self.text(&path) else { continue };
            self.notes.reads(&path);
            let folder = path.parent().unwrap_or(self.folder.path()).to_owned();
            told.add(&path.file_name().unwrap_or_default().to_string_lossy(), &text);
            for (name, mtl) in told.materials.drain() {
                all.entry(name).or_insert((mtl, folder.clone()));
            }
        }
        let joined = |words: &BTreeSet<String>| {
            words.iter().map(String::as_str).collect::<Vec<_>>().join(", ")
        };
        for (what, words, effect) in [
            ("unsupported MTL statements", joined(&told.skipped), "ignored"),
            ("unsupported options of MTL maps", joined(&told.options), "ignored"),
            ("malformed lines in MTL files", told.malformed.join("; "), "skipped"),
        ] {
            if !words.is_empty() {
                self.warn(&format!("{what}: {words}"), effect);
            }
        }
        let folder = self.folder.path().to_owned();
        for name in &named.textures {
            if self.image(&folder, name).is_some() {
                all.insert(name.clone(), (Mtl::of_image(name), folder.clone()));
            }
        }
        all
    }

    /// The files of `mtllib` statements: each statement is one name, or several if there is no such
    /// file.
    fn libraries(&self, statements: &[String]) -> Vec<PathBuf> {
        let mut found: Vec<PathBuf> = Vec::new();
        for statement in statements {
            let whole = self.find(self.folder.path(), statement);
            let names: Vec<&str> = match whole {
                Ok(_) => vec![statement],
                Err(_) => statement.split_ascii_whitespace().collect(),
            };
            for name in names {
                let path = self.find(self.folder.path(), name).inspect_err(|denied| {
                    self.denied(*denied, "material file", name, WITHOUT_FILE);
                });
                let path = path.ok().filter(|path| !found.contains(path));
                found.extend(path);
            }
        }
        if found.len() > MOST_FILES {
            let message = format!("the file names {} material files", found.len());
            self.warn(&message, &format!("only the first {MOST_FILES} are read"));
            found.truncate(MOST_FILES);
        }
        found
    }

    /// The content of an MTL file.
    fn text(&self, path: &Path) -> Option<Vec<u8>> {
        let mut text = Vec::new();
        let read = File::open(path).and_then(|file| file.take(LONGEST_FILE).read_to_end(&mut text));
        let read = read.inspect_err(|error| {
            let message = format!("cannot read {}: {error}", path.display());
            self.warn(&message, WITHOUT_FILE);
        });
        read.is_ok().then_some(text)
    }

    /// The path of an image named in a file in the folder `from`, if it exists and can be read.
    fn image(&self, from: &Path, name: &str) -> Option<PathBuf> {
        let effect = "only the material's colour is used";
        let found = self.find(from, name);
        let found = found.inspect_err(|denied| self.denied(*denied, "image", name, effect));
        found.ok().filter(|path| {
            let head = Head::of(&TextureSource::File(path.clone()));
            head.inspect_err(|error| self.warn(&error.to_string(), effect)).is_ok()
        })
    }

    /// The file with that name. Names may come from other systems, or from folders that no longer
    /// exist: the last part of a name is enough if that file is beside the OBJ file.
    fn find(&self, from: &Path, name: &str) -> Result<PathBuf, Denied> {
        let slashed = name.replace('\\', "/");
        let beside = self.folder.path();
        self.folder.find(from, name).or_else(|denied| {
            let others =
                [self.folder.find(from, &slashed), self.folder.find(beside, last_part(&slashed))];
            others.into_iter().flatten().next().ok_or(denied)
        })
    }

    fn denied(&self, denied: Denied, kind: &str, name: &str, effect: &str) {
        let (state, remedy) = match denied {
            Denied::Missing => ("missing", "put it beside the mesh; until then "),
            Denied::Outside => (
                "outside the folder of the mesh",
                "copy it there, or allow others with --allow-outside; ",
            ),
        };
        self.warn(&format!("the {kind} {name:?} is {state}"), &format!("{remedy}{effect}"));
    }

    /// Whether the mesh has the texture coordinates that a texture needs.
    fn has_uvs(&self, mesh: &MeshData) -> bool {
        if mesh.uvs.is_none() {
            let message = "textured faces have no texture coordinates (vt)";
            self.warn(message, "only their material's colour is used");
        }
        mesh.uvs.is_some()
    }

    /// Warns of materials that no file defines. A missing file has its own warning.
    fn warn_of_unknown(&self, named: &NamedMaterials, library: &HashMap<String, (Mtl, PathBuf)>) {
        /// Largest number of names in a warning.
        const NAMED: usize = 4;
        if library.is_empty() {
            return;
        }
        let mut unknown: Vec<&str> = Vec::new();
        let is_known =
            |name| library.contains_key(name) || named.textures.contains(name) || name.is_empty();
        for (_, name) in named.runs.iter().filter(|(_, name)| !is_known(name)) {
            if unknown.len() <= NAMED && !unknown.contains(&name.as_str()) {
                unknown.push(name);
            }
        }
        if unknown.is_empty() {
            return;
        }
        let more = if unknown.len() > NAMED { " and others" } else { "" };
        unknown.truncate(NAMED);
        let message =
            format!("these materials are not in any MTL file: {}{more}", unknown.join(", "));
        self.warn(&message, "their faces use the default material");
    }

    /// Adds a warning about the mesh file, once.
    fn warn(&self, message: &str, remedy: &str) {
        let error = Error::new(ErrorKind::Scene, message).in_file(self.file).remedy(remedy);
        self.notes.warn(&error);
    }
}
