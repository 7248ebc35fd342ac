//! Checkpoints: the finished units of a render, saved regularly and loaded to resume it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::part::{PartHeader, PartReader, Pass, StoredUnit};
use wavecrest_base::error::{Error, ErrorKind, Result};

/// The checkpoint of a render.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    /// The part file.
    pub file: PathBuf,
    /// The shortest time between two saves: a save happens when a unit is finished, and less often
    /// if saving takes long.
    pub every: Duration,
    /// Whether to resume from the file. Without a file, everything is rendered.
    pub resume: bool,
}

impl Checkpoint {
    /// The passes in the file for the render of `header`, their units, and whether some are left out. Tiles with samples that are not finite are
    /// left out and rendered again, so that these samples are counted and located again.
    ///
    /// # Errors
    /// If the file is damaged or of another render, or if it exists but resuming was not requested:
    /// no work is discarded.
    pub(super) fn load(
        &self,
        header: &PartHeader,
    ) -> Result<Option<(Pass, Vec<StoredUnit>, bool)>> {
        if !self.check()? {
            return Ok(None);
        }
        let mut reader = PartReader::open(&self.file)?;
        check_same(&self.file, &reader.header, header)?;
        let (mut units, mut invalid) = (Vec::new(), BTreeSet::new());
        while let Some(unit) = reader.next_unit()? {
            if unit.invalid > 0 {
                invalid.insert(unit.tile);
            }
            units.push(unit);
        }
        units.retain(|unit: &StoredUnit| !invalid.contains(&unit.tile));
        Ok(Some((reader.header.pass, units, !invalid.is_empty())))
    }

    /// Whether there is a file to resume from; call it before long work.
    ///
    /// # Errors
    /// If the file exists but resuming was not requested: no work is discarded.
    pub fn check(&self) -> Result<bool> {
        match self.file.try_exists() {
            Err(error) => Err(Error::io("cannot read the checkpoint", &self.file, error)),
            Ok(true) if !self.resume => {
                Err(Error::new(ErrorKind::Usage, "the checkpoint exists already")
                    .in_file(&self.file)
                    .remedy("resume from it with --resume, or remove it"))
            }
            Ok(exists) => Ok(exists),
        }
    }
}

/// Refuses a checkpoint of another render.
fn check_same(file: &Path, found: &PartHeader, header: &PartHeader) -> Result<()> {
    let remedies = [
        "use the same options, or another checkpoint file",
        "restore the scene, or use another checkpoint file",
    ];
    let names = ["the checkpoint", "this render"];
    found.identity.check_same(file, &header.identity, names, remedies)?;
    if found.shard == header.shard {
        return Ok(());
    }
    let name = |header: &PartHeader| {
        header.shard.map_or("the whole image".to_owned(), |shard| format!("shard {shard}"))
    };
    let error = Error::new(ErrorKind::Usage, "the checkpoint belongs to another shard");
    let remedy = format!("this render is {}; use one checkpoint file for each shard", name(header));
    Err(error.in_file(file).value(name(found)).remedy(remedy))
}
