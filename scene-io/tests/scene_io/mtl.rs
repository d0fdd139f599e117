//! What MTL files and their textures do to the faces of OBJ files.

use crate::support::textured::{
    BLUE, GREEN, RED, WHITE, close, hit, load, path, reflectance, write8,
};
use glam::Vec3;
use tyndall_core::{Rgb, Shading, SurfaceKind};
use tyndall_scene_io::{Scene, SceneFile};

const OBJ: &str = "mtllib a.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
vt 0 0
vt 1 0
vt 1 1
vt 0 1
usemtl it
f 1/1 2/2 3/3 4/4
";

fn obj(test: &str, obj: &str, mtl: &str) -> Result<SceneFile, String> {
    std::fs::write(path(test, "a.obj"), obj).unwrap();
    std::fs::write(path(test, "a.mtl"), format!("newmtl it\n{mtl}\n")).unwrap();
    load(test, "[[shapes]]\nkind = 'obj'\nfile = 'a.obj'")
}

#[test]
fn mtl_files_bring_their_textures() {
    let test = "mtl";
    write8(test, "four.png", 2, &[RED, GREEN, BLUE, WHITE]);
    write8(test, "hole in two.png", 2, &[[0, 0, 0, 255], WHITE]);
    let mtl = "map_Kd four.png\nmap_Ke -s 2 2 1 four.png\nKe 2 2 2\nillum 1\nmap_d hole in two.png";
    let scene: Scene<Rgb> = obj(test, OBJ, mtl).unwrap().build().unwrap();
    assert!(close(
        reflectance(&scene, &hit(&scene, 0.75, 0.75)),
        [0.0, 1.0, 0.0]
    ));
    let left = hit(&scene, 0.2, 0.7);
    assert_eq!(
        scene.surface_kind(&left),
        SurfaceKind::Null,
        "the image has alpha 1 and red 0"
    );
    let emitted = scene.emitted(&hit(&scene, 0.875, 0.375), Vec3::Z);
    assert!(close(emitted, [0.0, 2.0, 0.0]), "{emitted:?}");
}

#[test]
fn mtl_keys_choose_the_material() {
    let kind = |mtl: &str| {
        let scene: Scene<Rgb> = obj("mtl_keys", OBJ, mtl).unwrap().build().unwrap();
        let hit = hit(&scene, 0.5, 0.4);
        let glossy = reflectance(&scene, &hit).0.x;
        (scene.surface_kind(&hit), (glossy * 100.0).round())
    };
    use SurfaceKind::{Delta, Finite};
    assert_eq!(kind("Kd 0.5 0.5 0.5"), (Finite, 50.0));
    assert_eq!(kind("Kd 0.5 0.5 0.5\nKs 0 0 0\nillum 2"), (Finite, 50.0));
    assert_eq!(kind("Kd 0.5 0.5 0.5\nPr 0\nPm 1"), (Delta, 0.0));
    assert_eq!(kind("Kd 1 1 1\nPr 0\nTf 1 1 1\nNi 1.45"), (Delta, 0.0));
    assert_eq!(kind("Kd 0.5 0.5 0.5\nd 0.2\nillum 7\nNi 1.3"), (Delta, 0.0));
    // A highlight on top of the diffuse base.
    let (finite, glossy) = kind("Kd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nNs 100\nillum 2");
    assert!(finite == Finite && glossy > 60.0, "{glossy}");
}

#[test]
fn faces_without_texture_coordinates_are_said() {
    let bare = OBJ.replace("f 1/1 2/2 3/3 4/4", "f 1 2 3 4");
    write8("bare", "four.png", 2, &[RED, GREEN, BLUE, WHITE]);
    let file = obj("bare", &bare, "Kd 0.5 0.5 0.5\nmap_Kd four.png").unwrap();
    assert!(file.notices()[0].contains("no texture coordinates"));
    let text = "
        [materials.wood]
        kind = 'diffuse'
        reflectance = { file = 'four.png' }
        [[shapes]]
        kind = 'obj'
        file = 'a.obj'
        material = 'wood'";
    let why = load("bare", text).unwrap_err();
    assert!(
        why.contains("shapes.0") && why.contains("\"wood\" has textures"),
        "{why}"
    );
}

#[test]
fn bump_maps_are_left_out_and_said() {
    write8("bump", "bump.png", 1, &[[90, 90, 90, 255]]);
    let file = obj("bump", OBJ, "Kd 0.5 0.5 0.5\nmap_Bump -bm 2 bump.png").unwrap();
    assert!(file.notices()[0].contains("bump.png holds heights"));
}

/// The MTL file and its textures lie in a folder of their own, as exporters put them.
#[test]
fn textures_are_named_from_the_folder_of_the_mtl_file() {
    let test = "mtl_folder";
    std::fs::create_dir_all(path(test, "library")).unwrap();
    write8(test, "library/green.png", 1, &[GREEN]);
    std::fs::write(
        path(test, "library/b.mtl"),
        "newmtl other\nKd 1 0 0\nnewmtl it\nmap_Kd green.png\n",
    )
    .unwrap();
    let text = OBJ.replace("mtllib a.mtl", "mtllib a.mtl\nmtllib library/b.mtl");
    std::fs::write(path(test, "a.obj"), text).unwrap();
    std::fs::write(path(test, "a.mtl"), "newmtl plain\nKd 1 1 1\n").unwrap();
    let file = load(test, "[[shapes]]\nkind = 'obj'\nfile = 'a.obj'").unwrap();
    let scene: Scene<Rgb> = file.build().unwrap();
    assert!(close(
        reflectance(&scene, &hit(&scene, 0.5, 0.4)),
        [0.0, 1.0, 0.0]
    ));
}

/// `d` and `Tr` hold for materials of physically based rendering whatever `illum` says, and where
/// textures have nothing to lie on.
#[test]
fn alpha_holds() {
    let kind = |obj_text: &str, mtl: &str| {
        write8("alpha", "four.png", 2, &[RED, GREEN, BLUE, WHITE]);
        let scene: Scene<Rgb> = obj("alpha", obj_text, mtl).unwrap().build().unwrap();
        scene.surface_kind(&hit(&scene, 0.5, 0.4))
    };
    for illum in [2, 4, 6, 7, 9] {
        for gone in ["d 0", "Tr 1"] {
            let mtl = format!("Kd 0.5 0.5 0.5\nPr 0.5\n{gone}\nillum {illum}");
            assert_eq!(kind(OBJ, &mtl), SurfaceKind::Null, "{mtl}");
        }
    }
    let bare = OBJ.replace("f 1/1 2/2 3/3 4/4", "f 1 2 3 4");
    let textured = "Kd 0.5 0.5 0.5\nmap_Kd four.png\n";
    assert_eq!(kind(&bare, &format!("{textured}d 0")), SurfaceKind::Null);
    assert_eq!(kind(&bare, textured), SurfaceKind::Finite);
}
