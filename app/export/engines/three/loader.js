// Loads a level that Relume exported, and lights it by its lightmap (three.js r150 or newer).
//
//     const level = await loadLevel(renderer, './'); // the folder with scene.glb and lightmap.ktx2
//     scene.add(level.scene);                        // level is what GLTFLoader gives: cameras and all
//
// The lightmap has lighting in cd/m^2, and so has the level's emission: set renderer.toneMappingExposure.
import { LinearFilter } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';

export async function loadLevel(renderer, folder) {
    const textures = new KTX2Loader().detectSupport(renderer);
@ONE@    const [level, lightmap] = await Promise.all([
@ONE@        new GLTFLoader().loadAsync(folder + 'scene.glb'),
@ONE@        textures.loadAsync(folder + 'lightmap.ktx2'),
@ONE@    ]);
@MANY@    const pages = Array.from({ length: @PAGES@ }, (_, page) => textures.loadAsync(`${folder}lightmap.${page}.ktx2`));
@MANY@    const [level, ...lightmaps] = await Promise.all([new GLTFLoader().loadAsync(folder + 'scene.glb'), ...pages]);
    textures.dispose();
@ONE@    lightmap.channel = 1; // TEXCOORD_1
@ONE@    lightmap.minFilter = lightmap.magFilter = LinearFilter;
@ONE@    lightmap.needsUpdate = true;
@MANY@    for (const lightmap of lightmaps) {
@MANY@        lightmap.channel = 1; // TEXCOORD_1
@MANY@        lightmap.minFilter = lightmap.magFilter = LinearFilter;
@MANY@        lightmap.needsUpdate = true;
@MANY@    }
    const anisotropy = renderer.capabilities.getMaxAnisotropy();
    level.scene.traverse((object) => {
        for (const material of [object.material ?? []].flat()) {
            for (const map of [material.map, material.metalnessMap, material.emissiveMap]) if (map) map.anisotropy = anisotropy;
            // A loader that knows MOZ_lightmap has put its 8-bit picture here already.
            if (!material.userData.gltfExtensions?.MOZ_lightmap && !material.lightMap) continue;
@ONE@            material.lightMap = lightmap;
@MANY@            material.lightMap = lightmaps[material.userData.relume?.page ?? 0];
            material.lightMapIntensity = Math.PI; // three.js divides irradiance by pi, the lightmap has it divided
            material.needsUpdate = true;
        }
    });
    return level;
}
