//! A small court with a colonnade, a truss arch, trees, steps and spheres.

use umbra4_core::glam::DVec3;

use super::{Builder, BuiltinScene, FOV, View, colonnade, ground, spheres, steps, tree, truss, window};

pub(super) fn scene() -> BuiltinScene {
    let mut builder = Builder::default();
    ground::build(&mut builder);
    colonnade::build(&mut builder);
    truss::build(&mut builder);
    tree::build(&mut builder);
    steps::build(&mut builder);
    spheres::build(&mut builder);
    let view = View {
        eye: BuiltinScene::EYE,
        target: BuiltinScene::TARGET,
        fov: FOV,
        focus: BuiltinScene::FOCUS,
        fade: BuiltinScene::FADE,
    };
    // Up on the left, it faces the middle of the court.
    let light = window(DVec3::new(-7.6, 11.2, 3.6), DVec3::new(0.8, 0.3, 0.2), 2.6);
    BuiltinScene::of(builder, light, view)
}
