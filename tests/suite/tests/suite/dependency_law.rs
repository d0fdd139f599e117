//! The dependency law: which crate may know which.

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand};
use std::collections::BTreeSet;

/// Crates below the integrators, each allowed the workspace crates named.
const ROOMS: &[(&str, &[&str])] = &[
    ("tyndall-core", &[]),
    ("tyndall-media", &["tyndall-core"]),
    ("tyndall-walk", &["tyndall-core"]),
    ("tyndall-density", &["tyndall-core"]),
    ("tyndall-driver", &["tyndall-core"]),
    ("tyndall-kd-tree", &["tyndall-core"]),
    ("tyndall-bvh", &["tyndall-core"]),
    ("tyndall-octree", &["tyndall-core"]),
    ("tyndall-surface", &["tyndall-core"]),
];
/// Crates above them, which may depend on anything below.
const ABOVE: &[&str] = &[
    "tyndall",
    "tyndall-scene-io",
    "tyndall-testkit",
    "tyndall-suite",
    "tyndall-host-rpt",
];
/// What an integrator may depend on: not `media`, or the Medium trait is wrong; not another
/// integrator, or the shared piece is in the wrong place.
const INTEGRATOR_MAY: &[&str] = &[
    "tyndall-core",
    "tyndall-walk",
    "tyndall-density",
    "tyndall-kd-tree",
    "tyndall-bvh",
    "tyndall-octree",
    "tyndall-photons",
    "glam",
    "rayon",
];
const CORE_MAY: &[&str] = &["glam"];

fn metadata() -> Metadata {
    MetadataCommand::new()
        .manifest_path(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml"))
        .no_deps()
        .exec()
        .expect("cargo metadata runs in the workspace")
}

/// Every edge that the law forbids, as a sentence.
fn offences(edges: impl IntoIterator<Item = (String, String)>) -> Vec<String> {
    let mut offences = Vec::new();
    for (from, to) in edges {
        let room = ROOMS.iter().find(|(name, _)| *name == from);
        let lawful = match room {
            _ if from == "tyndall-core" => CORE_MAY.contains(&to.as_str()),
            Some((_, may)) => !to.starts_with("tyndall") || may.contains(&to.as_str()),
            None if ABOVE.contains(&from.as_str()) => true,
            None => INTEGRATOR_MAY.contains(&to.as_str()),
        };
        if !lawful {
            offences.push(format!("{from} must not depend on {to}"));
        }
    }
    offences
}

#[test]
fn every_edge_is_lawful() {
    let metadata = metadata();
    let edges = metadata.workspace_packages().into_iter().flat_map(|p| {
        p.dependencies
            .iter()
            .filter(|d| d.kind != DependencyKind::Development)
            .map(|d| (p.name.to_string(), d.name.clone()))
            .collect::<Vec<_>>()
    });
    let offences = offences(edges);
    assert!(offences.is_empty(), "{}", offences.join("\n"));
}

#[test]
fn a_forbidden_edge_is_an_offence() {
    let edge = |from: &str, to: &str| [(from.to_string(), to.to_string())];
    for (from, to) in [
        ("tyndall-core", "rayon"),
        ("tyndall-walk", "tyndall-media"),
        ("tyndall-path", "tyndall-media"),
        ("tyndall-path", "tyndall-driver"),
        ("tyndall-vrl", "tyndall-photon-beams"),
    ] {
        assert_eq!(offences(edge(from, to)).len(), 1, "{from} → {to}");
    }
}

#[test]
fn a_folder_is_its_package_without_the_prefix() {
    let metadata = metadata();
    let odd: BTreeSet<_> = metadata
        .workspace_packages()
        .into_iter()
        .filter(|p| {
            let folder = p.manifest_path.parent().and_then(|f| f.file_name());
            let name = p.name.as_str();
            folder != name.strip_prefix("tyndall-")
                && !matches!(name, "tyndall" | "tyndall-host-rpt")
        })
        .map(|p| p.name.to_string())
        .collect();
    assert!(odd.is_empty(), "{odd:?}");
}
