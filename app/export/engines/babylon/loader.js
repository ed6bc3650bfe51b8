// Lights a level that Relume exported by its lightmap (Babylon.js 7 or newer, WebGL or WebGPU).
//
//     const level = await loadLevel(scene, './'); // the folder with scene.glb and lightmap.ktx2
//
// The lightmap has lighting in cd/m^2, and so has the level's emission: set scene.imageProcessingConfiguration.exposure.

// Babylon.js adds a lightmap to the picture as it is. This multiplies it with the surface's colour, as light is.
class LightmapTimesAlbedo extends BABYLON.MaterialPluginBase {
    constructor(material) {
        super(material, 'LightmapTimesAlbedo', 200, { RELUME_LIGHTMAP: true });
        this._enable(true);
    }
    getClassName() { return 'LightmapTimesAlbedo'; }
    isCompatible() { return true; }
    prepareDefines(defines) { defines.RELUME_LIGHTMAP = true; }
    getCustomCode(shaderType, language) {
        if (shaderType !== 'fragment') return null;
        const code = language === BABYLON.ShaderLanguage.WGSL
            ? 'finalColor = vec4f(finalColor.rgb + lightmapColor.rgb * (surfaceAlbedo - vec3f(1.0)), finalColor.a);'
            : 'finalColor.rgb += lightmapColor.rgb * (surfaceAlbedo - vec3(1.0));';
        return { CUSTOM_FRAGMENT_BEFORE_FOG: code };
    }
}

// Reads a KTX 2.0 file of half floats, one level, not supercompressed, which is what the export has.
async function loadHalfFloats(scene, url) {
    const bytes = await (await fetch(url)).arrayBuffer();
    const header = new DataView(bytes);
    const [width, height] = [header.getUint32(20, true), header.getUint32(24, true)];
    const [offset, length] = [80, 88].map((at) => Number(header.getBigUint64(at, true)));
    const texture = new BABYLON.RawTexture(
        new Uint16Array(bytes, offset, length / 2), width, height, BABYLON.Constants.TEXTUREFORMAT_RGBA, scene, false, false,
        BABYLON.Texture.BILINEAR_SAMPLINGMODE, BABYLON.Constants.TEXTURETYPE_HALF_FLOAT);
    texture.gammaSpace = false;
    texture.wrapU = texture.wrapV = BABYLON.Texture.CLAMP_ADDRESSMODE;
    return texture;
}

async function loadLevel(scene, folder) {
@ONE@    const lit = new Set(); // names of the materials that the lightmap lights
@MANY@    const lit = new Map(); // from names of the materials that the lightmap lights to its page that does
    const plugin = BABYLON.SceneLoader.OnPluginActivatedObservable.addOnce((loader) => {
        loader.onParsedObservable?.add(({ json }) => {
@ONE@            for (const material of json.materials ?? []) if (material.extensions?.MOZ_lightmap) lit.add(material.name);
@MANY@            for (const material of json.materials ?? [])
@MANY@                if (material.extensions?.MOZ_lightmap) lit.set(material.name, material.extras?.relume?.page ?? 0);
        });
    });
@ONE@    const [level, lightmap] = await Promise.all([
@ONE@        BABYLON.SceneLoader.AppendAsync(folder, 'scene.glb', scene),
@ONE@        loadHalfFloats(scene, folder + 'lightmap.ktx2'),
@ONE@    ]);
@MANY@    const [level, ...lightmaps] = await Promise.all([
@MANY@        BABYLON.SceneLoader.AppendAsync(folder, 'scene.glb', scene),
@MANY@        ...Array.from({ length: @PAGES@ }, (_, page) => loadHalfFloats(scene, `${folder}lightmap.${page}.ktx2`)),
@MANY@    ]);
    BABYLON.SceneLoader.OnPluginActivatedObservable.remove(plugin);
@ONE@    lightmap.coordinatesIndex = 1; // TEXCOORD_1
@MANY@    for (const lightmap of lightmaps) lightmap.coordinatesIndex = 1; // TEXCOORD_1
    for (const material of scene.materials) {
        for (const map of [material.albedoTexture, material.metallicTexture, material.emissiveTexture])
            if (map) map.anisotropicFilteringLevel = 16;
        if (!lit.has(material.name)) continue;
@ONE@        material.lightmapTexture = lightmap;
@MANY@        material.lightmapTexture = lightmaps[lit.get(material.name)];
        new LightmapTimesAlbedo(material);
    }
    return level;
}
