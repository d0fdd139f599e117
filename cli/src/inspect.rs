//! `tyndall inspect`.

mod volume;

use crate::arguments::InspectArguments;
use crate::failure::Error;
use crate::render::tell_notices;
use serde::Serialize;
use std::fmt::{self, Display};
use std::io::{self, Write};
use tyndall_core::Rgb;
use tyndall_scene_io::{
    CameraSummary, GeometrySummary, LightSummary, MediumSummary, SceneFile, Summary, VolumeFormat,
    VolumeSummary,
};

/// Prints what the scene or the volume holds.
pub(crate) fn run(arguments: &InspectArguments) -> Result<(), Error> {
    let path = &arguments.file;
    if VolumeFormat::of(path).is_none() {
        return scene(arguments);
    }
    if !arguments.set.is_empty() {
        let path = path.display();
        return Err(Error::CommandLine(format!(
            "`--set`: {path} is a volume, which has no keys: leave it out, or name a scene file"
        )));
    }
    let summary = VolumeSummary::read(path)?;
    print(arguments, &summary, volume::Report(&summary))
}

fn scene(arguments: &InspectArguments) -> Result<(), Error> {
    let file = SceneFile::load(&arguments.file, &arguments.set)?;
    tell_notices(&file);
    let summary = if file.is_grey() {
        Summary::new(&file, &file.build::<f32>()?)
    } else {
        Summary::new(&file, &file.build::<Rgb>()?)
    };
    print(arguments, &summary, Report(&summary))
}

/// As JSON, or as text for people.
fn print(
    arguments: &InspectArguments,
    summary: &impl Serialize,
    report: impl Display,
) -> Result<(), Error> {
    let text = if arguments.json {
        serde_json::to_string_pretty(summary).map_err(io::Error::from)?
    } else {
        report.to_string()
    };
    match writeln!(io::stdout(), "{text}") {
        // Whoever reads has read enough.
        Err(e) if e.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        written => Ok(written?),
    }
}

/// A summary for people: one line a thing, its name in front.
struct Report<'a>(&'a Summary);

impl Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let summary = self.0;
        camera(f, &summary.camera)?;
        match &summary.bounds {
            Some([min, max]) => writeln!(f, "bounds      {} to {}", point(min), point(max))?,
            None => writeln!(f, "bounds      none: there are no surfaces and no lamps")?,
        }
        geometry(f, &summary.geometry)?;
        if summary.lights.is_empty() {
            writeln!(
                f,
                "lights      none: the image will be black unless a medium glows"
            )?;
        }
        summary.lights.iter().try_for_each(|l| light(f, l))?;
        summary.media.iter().try_for_each(|m| medium(f, m))?;
        for (what, bytes) in [
            ("meshes", summary.geometry.mesh_bytes),
            ("grids", summary.grid_bytes),
            ("textures", summary.texture_bytes),
        ] {
            if bytes > 0 {
                writeln!(f, "memory      {what} {}", indicatif::HumanBytes(bytes))?;
            }
        }
        let needed = serde_json::to_value(summary.transport.needed).unwrap_or_default();
        let needed = needed.as_str().unwrap_or_default().to_owned();
        write!(f, "transport   {needed}, {} channels", summary.channels)?;
        for advice in &summary.transport.advice {
            write!(f, "\n  - {advice}")?;
        }
        Ok(())
    }
}

fn camera(f: &mut fmt::Formatter<'_>, camera: &CameraSummary) -> fmt::Result {
    let [width, height] = camera.resolution;
    let medium = camera.medium.as_deref().unwrap_or("vacuum");
    let position = point(&camera.position);
    writeln!(
        f,
        "camera      {width}×{height} pixels at {position}, in {medium}"
    )
}

fn geometry(f: &mut fmt::Formatter<'_>, geometry: &GeometrySummary) -> fmt::Result {
    let shapes = geometry
        .shapes
        .iter()
        .map(|(kind, n)| format!("{n} {kind}"));
    let shapes: Vec<_> = shapes.collect();
    writeln!(f, "shapes      {}", some_or_none(&shapes))?;
    let (all, unique) = (geometry.triangles, geometry.unique_triangles);
    writeln!(f, "triangles   {all}, of which {unique} are stored")
}

fn light(f: &mut fmt::Formatter<'_>, light: &LightSummary) -> fmt::Result {
    let LightSummary {
        kind, count, power, ..
    } = light;
    writeln!(f, "light       {count} {kind}, {power:.4} W")
}

fn medium(f: &mut fmt::Formatter<'_>, medium: &MediumSummary) -> fmt::Result {
    let name = &medium.name;
    write!(f, "medium      {name}: {}", medium.kind)?;
    if let Some([x, y, z]) = medium.voxels {
        write!(f, " of {x}×{y}×{z} voxels")?;
    }
    if let Some(active) = medium.active_voxels {
        write!(f, " of {} active voxels", indicatif::HumanCount(active))?;
    }
    let place = match (medium.fills_space, medium.shapes) {
        (true, _) => "fills space outside of shapes".to_owned(),
        (false, 0) => "fills nothing".into(),
        (false, 1) => "fills 1 shape".into(),
        (false, n) => format!("fills {n} shapes"),
    };
    let path = medium.mean_free_path;
    let path = path.map_or("endless".into(), |length| format!("{length:.4}"));
    let extent = match medium.extent.is_finite() {
        true => format!("{:.3}", medium.extent),
        false => "endless space".into(),
    };
    let glow = if medium.emits { ", glows" } else { "" };
    writeln!(f, ", {place}{glow}")?;
    writeln!(
        f,
        "            albedo {}, g {:.3}, mean free path {path}, optical depth {:.3} over {extent}",
        channels(&medium.albedo),
        medium.anisotropy,
        medium.optical_depth,
    )
}

/// One number if the channels agree.
fn channels([r, g, b]: &[f32; 3]) -> String {
    if r == g && g == b {
        format!("{r:.3}")
    } else {
        format!("[{r:.3}, {g:.3}, {b:.3}]")
    }
}

fn point(p: &[f64; 3]) -> String {
    // −0 is 0 to a reader.
    let [x, y, z] = p.map(|x| x + 0.0);
    format!("[{x:.4}, {y:.4}, {z:.4}]")
}

fn some_or_none(list: &[String]) -> String {
    match list {
        [] => "none".into(),
        list => list.join(", "),
    }
}
