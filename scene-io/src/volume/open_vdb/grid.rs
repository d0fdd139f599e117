//! What a file says of a grid before its tree.

use super::codec::{ACTIVE_MASK, Codec};
use super::cursor::Cursor;
use super::format::{Format, Number};
use super::{map, tree};
use crate::volume::message::{in_grid, shown};
use crate::volume::{GridClass, Voxels};
use glam::DAffine3;

/// Between the name of a grid and a number that tells it from others of this name.
pub(in crate::volume) const SEPARATOR: u8 = 0x1e;
/// After the type of a tree whose numbers are written as halves.
pub(super) const HALF_SUFFIX: &[u8] = b"_HalfFloat";
const FORM: &[u8] = b"_5_4_3";

/// A grid whose tree has not been read.
#[derive(Clone, Debug)]
pub(super) struct Grid<'a> {
    pub(super) name: String,
    /// The name with its number.
    pub(super) unique: &'a [u8],
    /// The unique name of the grid whose tree it shares, or nothing.
    pub(super) parent: &'a [u8],
    pub(super) class: GridClass,
    kind: Kind,
    saved_as_half: bool,
    /// Where its voxels are, or why that is not read.
    pub(super) to_world: Result<DAffine3, String>,
    flags: u32,
    /// At the tree.
    tree: Cursor<'a>,
}

/// What is kept of a voxel.
#[derive(Clone, Debug, PartialEq)]
enum Kind {
    Scalar(Number),
    Vector(Number),
    /// A type or a form of tree that is not read, by its name.
    Other(String),
}

impl Kind {
    fn of(tree: &[u8]) -> Self {
        let tree = tree.strip_prefix(b"Tree_").unwrap_or(tree);
        match tree.strip_suffix(FORM) {
            Some(b"float") => Self::Scalar(Number::Single),
            Some(b"half") => Self::Scalar(Number::Half),
            Some(b"double") => Self::Scalar(Number::Double),
            Some(b"vec3s") => Self::Vector(Number::Single),
            Some(b"vec3d") => Self::Vector(Number::Double),
            Some(other) => Self::Other(String::from_utf8_lossy(other).into_owned()),
            None => Self::Other(String::from_utf8_lossy(tree).into_owned()),
        }
    }
}

impl<'a> Grid<'a> {
    /// Reads the next grid of a file up to its tree and, with `offsets`, goes to its end.
    pub(super) fn read(cursor: &mut Cursor<'a>, offsets: bool) -> Result<Self, String> {
        let names = [cursor.string()?, cursor.string()?, cursor.string()?];
        let name = names[0].split(|&byte| byte == SEPARATOR).next();
        let name = name.unwrap_or_default();
        let in_grid = |problem: String| in_grid(name, problem);
        let (start, _blocks, end) = (cursor.i64()?, cursor.i64()?, cursor.i64()?);
        if !offsets {
            return Self::head(names, name, cursor).map_err(in_grid);
        }
        let mut body = cursor.within(start, end).map_err(in_grid)?;
        cursor.seek(usize::try_from(end).unwrap_or(usize::MAX));
        Self::head(names, name, &mut body).map_err(in_grid)
    }

    fn head(
        [unique, kind, parent]: [&'a [u8]; 3],
        name: &[u8],
        body: &mut Cursor<'a>,
    ) -> Result<Self, String> {
        let (kind, suffixed) = match kind.strip_suffix(HALF_SUFFIX) {
            Some(kind) => (kind, true),
            None => (kind, false),
        };
        let flags = body.u32()?;
        let (mut class, mut half) = (GridClass::Unknown, suffixed);
        metadata(body, |name, value| match name {
            b"class" => class = class_of(value),
            b"is_saved_as_half_float" => half |= value == [1],
            _ => {}
        })?;
        Ok(Self {
            name: String::from_utf8_lossy(name).into_owned(),
            unique,
            parent,
            class,
            kind: Kind::of(kind),
            saved_as_half: half,
            to_world: map::read(body),
            flags,
            tree: *body,
        })
    }

    /// The type of its values.
    pub(super) fn kind(&self) -> String {
        let kind = match (&self.kind, self.saved_as_half) {
            (Kind::Other(name), _) => name,
            (Kind::Scalar(Number::Half), _) | (Kind::Scalar(_), true) => "half",
            (Kind::Vector(Number::Half), _) | (Kind::Vector(_), true) => "vec3h",
            (Kind::Scalar(Number::Single), _) => "float",
            (Kind::Scalar(Number::Double), _) => "double",
            (Kind::Vector(Number::Single), _) => "vec3s",
            (Kind::Vector(Number::Double), _) => "vec3d",
        };
        kind.to_owned()
    }

    /// Reads its tree; for where it is see [`Grid::to_world`].
    pub(super) fn tree(&self) -> Result<Voxels, String> {
        self.tree_at(&mut self.tree.clone())
    }

    /// Reads its tree, which begins where the cursor is.
    pub(super) fn tree_at(&self, cursor: &mut Cursor<'a>) -> Result<Voxels, String> {
        if let Some(why) = self.unsupported() {
            return Err(why);
        }
        let format = |number| {
            Ok::<_, String>(Format {
                number,
                // OpenVDB has no smaller type for halves, and writes them as what they are.
                saved_as_half: self.saved_as_half && number != Number::Half,
                active_only: self.flags & ACTIVE_MASK != 0,
                codec: Codec::new(self.flags)?,
            })
        };
        Ok(match &self.kind {
            Kind::Scalar(number) => Voxels::Scalar(tree::read(cursor, format(*number)?)?),
            Kind::Vector(number) => Voxels::Vector(tree::read(cursor, format(*number)?)?),
            Kind::Other(_) => Voxels::Unread,
        })
    }

    /// Why it cannot be read whatever its tree holds: its type, or its transform.
    pub(super) fn unsupported(&self) -> Option<String> {
        match &self.kind {
            Kind::Other(kind) => Some(unsupported(kind)),
            Kind::Scalar(_) | Kind::Vector(_) => self.to_world.clone().err(),
        }
    }
}

fn unsupported(kind: &str) -> String {
    format!(
        "it is of type `{}`, which is not read: export it as float, half, double, vec3s or vec3d in the tree 5_4_3",
        shown(kind.as_bytes())
    )
}

/// Visits a list of metadata, whatever their types.
pub(super) fn metadata<'a>(
    cursor: &mut Cursor<'a>,
    mut visit: impl FnMut(&'a [u8], &'a [u8]),
) -> Result<(), String> {
    for _ in 0..cursor.u32()? {
        let (name, _type, value) = (cursor.string()?, cursor.string()?, cursor.string()?);
        visit(name, value);
    }
    Ok(())
}

fn class_of(value: &[u8]) -> GridClass {
    match value {
        b"fog volume" => GridClass::FogVolume,
        b"level set" => GridClass::LevelSet,
        b"staggered" => GridClass::Staggered,
        _ => GridClass::Unknown,
    }
}

/// The name of a class in metadata.
pub(super) fn class_name(class: GridClass) -> &'static str {
    match class {
        GridClass::Unknown => "unknown",
        GridClass::FogVolume => "fog volume",
        GridClass::LevelSet => "level set",
        GridClass::Staggered => "staggered",
    }
}
