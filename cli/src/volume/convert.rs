//! `tyndall volume convert`.

use super::ConvertArguments;
use crate::failure::Error;
use crate::progress::line;
use indicatif::HumanBytes;
use tyndall_scene_io::{
    ConversionError, GridClass, NanoCodec, VolumeFormat, VolumeGrid, check_writable, read_grids,
    write_nano_vdb, write_open_vdb, write_vol,
};

/// Reads grids, changes them as asked for, and writes them.
pub(super) fn run(arguments: &ConvertArguments) -> Result<(), Error> {
    let ConvertArguments { input, output, .. } = arguments;
    check_combination(arguments)?;
    check_writable(&output.path)?;
    let grids = readable(arguments)?;
    if arguments.fog && !grids.iter().any(|grid| grid.class == GridClass::LevelSet) {
        line(&format!(
            "notice: {}: no grid is a level set: --fog changes none",
            input.display()
        ));
    }
    let grids = grids.into_iter().map(|grid| changed(arguments, grid));
    let grids: Vec<_> = grids.collect::<Result<_, _>>()?;
    match output.format {
        VolumeFormat::NanoVdb => write_nano_vdb(&output.path, &grids, NanoCodec::Zip)?,
        VolumeFormat::Vol => write_vol(&output.path, only(arguments, &grids)?)?,
        VolumeFormat::OpenVdb => write_open_vdb(&output.path, &grids)?,
    }
    let size = HumanBytes(std::fs::metadata(&output.path).map_or(0, |about| about.len()));
    line(&format!(
        "{}: {}, {size}",
        output.path.display(),
        names(&grids)
    ));
    Ok(())
}

/// The grids that are asked for, or all that can be read; the others are told.
fn readable(arguments: &ConvertArguments) -> Result<Vec<VolumeGrid>, Error> {
    let mut grids = read_grids(&arguments.input, &arguments.grids)?;
    let why = |grid: &VolumeGrid| {
        Some(format!(
            "grid `{}`: {}",
            grid.name,
            grid.unsupported.as_ref()?
        ))
    };
    let left_out: Vec<_> = grids.iter().filter_map(why).collect();
    grids.retain(|grid| grid.unsupported.is_none());
    if grids.is_empty() {
        let problem = match left_out.as_slice() {
            [] => "holds no grid: export one".to_owned(),
            left_out => format!("holds no grid that can be read: {}", left_out.join("; ")),
        };
        return Err(refusal(arguments, problem));
    }
    for why in left_out {
        let input = arguments.input.display();
        line(&format!("notice: {input}: left out is {why}"));
    }
    Ok(grids)
}

/// Whether the flags can be had together.
fn check_combination(arguments: &ConvertArguments) -> Result<(), Error> {
    let ConvertArguments {
        input,
        output,
        half,
        ..
    } = arguments;
    let (from, to) = (input.display(), output.path.display());
    if *half && output.format != VolumeFormat::OpenVdb {
        return Err(Error::CommandLine(format!(
            "`--half`: {to} is written in 32-bit floats: leave it out, or write .vdb"
        )));
    }
    if output.format == VolumeFormat::Vol && VolumeFormat::of(input) == Some(VolumeFormat::Vol) {
        return Err(Error::CommandLine(format!(
            "`--output`: {from} is a .vol file as {to}: copy it, or write .vdb or .nvdb"
        )));
    }
    Ok(())
}

/// A grid after `--fog` and `--half`.
fn changed(arguments: &ConvertArguments, mut grid: VolumeGrid) -> Result<VolumeGrid, Error> {
    let name = grid.name.clone();
    let change = || -> Result<_, ConversionError> {
        if arguments.fog {
            grid = grid.into_fog()?;
        }
        if arguments.half {
            grid = grid.into_half()?;
        }
        Ok(grid)
    };
    change().map_err(|why| refusal(arguments, format!("grid `{name}`: {why}")))
}

/// The one grid for a `.vol` file.
fn only<'a>(
    arguments: &ConvertArguments,
    grids: &'a [VolumeGrid],
) -> Result<&'a VolumeGrid, Error> {
    match grids {
        [grid] if grid.class == GridClass::LevelSet => {
            let name = &grid.name;
            let problem = format!(
                "grid `{name}` is a level set, and a .vol file a density: make it fog with `--fog`"
            );
            Err(refusal(arguments, problem))
        }
        [grid] => Ok(grid),
        grids => {
            let names = names(grids);
            let problem = format!(
                "has grids {names}, and a .vol file one: choose it with `--grid`, or write .vdb or .nvdb"
            );
            Err(refusal(arguments, problem))
        }
    }
}

fn names(grids: &[VolumeGrid]) -> String {
    let names: Vec<_> = grids
        .iter()
        .map(|grid| format!("`{}`", grid.name))
        .collect();
    names.join(", ")
}

/// What is wrong with the volume that is read.
fn refusal(arguments: &ConvertArguments, problem: impl Into<String>) -> Error {
    Error::Scene(tyndall_scene_io::Error::Volume {
        path: arguments.input.clone(),
        problem: problem.into(),
    })
}
