//! Lights a level that Relume exported by its lightmap, as the file's MOZ_lightmap says.
//!
//! Bevy 0.17 or newer, with its features "ktx2" and "zstd". Copy the exported folder into `assets/`, then:
//!
//! ```ignore
//! app.add_plugins(relume_lightmap::RelumeLightmapPlugin);
//! // in a system of Startup:
//! relume_lightmap::spawn_level(&mut commands, &asset_server, "level");
//! commands.spawn((
//!     Camera3d::default(),
//!     bevy::camera::Exposure { ev100: relume_lightmap::EV100 },
//!     AmbientLight { brightness: 0.0, ..default() }, // the lightmap has all light
//! ));
//! ```
@ONE@use bevy::gltf::{Gltf, GltfLoaderSettings, GltfMaterialName};
@MANY@use bevy::gltf::{Gltf, GltfMaterialName};
use bevy::pbr::Lightmap;
use bevy::prelude::*;
use bevy::prelude::WorldAssetRoot as LevelRoot; // before Bevy 0.19: SceneRoot
@ONE@use std::collections::HashSet;
@MANY@use std::collections::HashMap;

/// The exposure at which Relume showed the level. Lightmap and emission are in cd/m^2.
pub const EV100: f32 = @EV100@;

@MANY@/// The pages that light materials, by their names.
@MANY@const PAGES: &[(&str, usize)] = &[
@MANY@@EACH@    ("@MATERIAL@", @PAGE@),
@MANY@];
@MANY@
/// A level whose lightmap is on its way or in place.
#[derive(Resource)]
pub struct RelumeLevel {
    gltf: Handle<Gltf>,
@ONE@    lightmap: Handle<Image>,
@ONE@    /// Names of the materials that the lightmap lights; none as long as the file is being read.
@ONE@    lit: Option<HashSet<String>>,
@MANY@    lightmaps: Vec<Handle<Image>>,
@MANY@    /// Pages by the names of the materials that they light; none as long as the file is being read.
@MANY@    lit: Option<HashMap<&'static str, usize>>,
}

pub struct RelumeLightmapPlugin;

impl Plugin for RelumeLightmapPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Update, (begin_level, light_meshes).chain().run_if(resource_exists::<RelumeLevel>));
    }
}

@ONE@/// Loads scene.glb and lightmap.ktx2 of a folder below `assets/`, and shows them when they are read.
@MANY@/// Loads scene.glb, lightmap.0.ktx2 and so on of a folder below `assets/`, and shows them when they are read.
pub fn spawn_level(commands: &mut Commands, asset_server: &AssetServer, folder: &str) {
    commands.insert_resource(RelumeLevel {
@ONE@        gltf: asset_server.load_with_settings(
@ONE@            format!("{folder}/scene.glb"),
@ONE@            |settings: &mut GltfLoaderSettings| settings.include_source = true,
@ONE@        ),
@ONE@        lightmap: asset_server.load(format!("{folder}/lightmap.ktx2")),
@MANY@        gltf: asset_server.load(format!("{folder}/scene.glb")),
@MANY@        lightmaps: (0..@PAGES@).map(|page| asset_server.load(format!("{folder}/lightmap.{page}.ktx2"))).collect(),
        lit: None,
    });
}

fn begin_level(mut commands: Commands, files: Res<Assets<Gltf>>, mut level: ResMut<RelumeLevel>) {
    if level.lit.is_some() {
        return;
    }
    let Some(file) = files.get(&level.gltf) else { return };
@ONE@    let Some(source) = &file.source else { return };
@ONE@    let lit = source
@ONE@        .document
@ONE@        .materials()
@ONE@        .filter(|material| material.extension_value("MOZ_lightmap").is_some())
@ONE@        .filter_map(|material| material.name().map(str::to_string))
@ONE@        .collect();
@ONE@    level.lit = Some(lit);
@MANY@    level.lit = Some(PAGES.iter().copied().collect());
    if let Some(scene) = &file.default_scene {
        commands.spawn(LevelRoot(scene.clone()));
    }
}

fn light_meshes(
    mut commands: Commands,
    level: Res<RelumeLevel>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    meshes: Query<(Entity, &GltfMaterialName, &MeshMaterial3d<StandardMaterial>), Added<Mesh3d>>,
) {
    let Some(lit) = &level.lit else { return };
    for (entity, name, material) in &meshes {
        #[allow(unused_mut)] // before Bevy 0.19 it is a plain reference
        if let Some(mut material) = materials.get_mut(&material.0) {
            material.lightmap_exposure = 1.0;
            material.emissive_exposure_weight = 1.0; // emission is in cd/m^2, too
        }
@ONE@        if lit.contains(&name.0) {
@ONE@            commands.entity(entity).insert(Lightmap { image: level.lightmap.clone(), ..default() });
@ONE@        }
@MANY@        if let Some(&page) = lit.get(name.0.as_str()) {
@MANY@            commands.entity(entity).insert(Lightmap { image: level.lightmaps[page].clone(), ..default() });
@MANY@        }
    }
}
