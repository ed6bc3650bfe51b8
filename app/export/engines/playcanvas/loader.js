// Loads a level that Relume exported, and lights it by its lightmap (PlayCanvas 2).
//
//     const entity = await loadLevel(pc, app, './'); // the folder with scene.glb and lightmap.ktx2
//
// The lightmap has lighting in cd/m^2, and so has the level's emission: set app.scene.exposure or the camera's.

// Reads a KTX 2.0 file of half floats, one level, not supercompressed, which is what the export has.
async function loadHalfFloats(pc, device, url) {
    const bytes = await (await fetch(url)).arrayBuffer();
    const header = new DataView(bytes);
    const [offset, length] = [80, 88].map((at) => Number(header.getBigUint64(at, true)));
    return new pc.Texture(device, {
        name: 'lightmap', width: header.getUint32(20, true), height: header.getUint32(24, true),
        format: pc.PIXELFORMAT_RGBA16F, mipmaps: false, minFilter: pc.FILTER_LINEAR, magFilter: pc.FILTER_LINEAR,
        addressU: pc.ADDRESS_CLAMP_TO_EDGE, addressV: pc.ADDRESS_CLAMP_TO_EDGE,
        levels: [new Uint16Array(bytes, offset, length / 2)],
    });
}

export async function loadLevel(pc, app, folder) {
@ONE@    const lit = new Set(); // names of the materials that the lightmap lights
@MANY@    const lit = new Map(); // from materials that the lightmap lights to its page that does
    const asset = new pc.Asset('level', 'container', { url: folder + 'scene.glb' }, {}, {
@ONE@        material: { postprocess: (json, material) => { if (json.extensions?.MOZ_lightmap) lit.add(material); } },
@MANY@        material: { postprocess: (json, material) => {
@MANY@            if (json.extensions?.MOZ_lightmap) lit.set(material, json.extras?.relume?.page ?? 0);
@MANY@        } },
    });
    const loaded = new Promise((resolve, reject) => { asset.ready(resolve); asset.once('error', reject); });
    app.assets.add(asset);
    app.assets.load(asset);
@ONE@    const [, lightmap] = await Promise.all([loaded, loadHalfFloats(pc, app.graphicsDevice, folder + 'lightmap.ktx2')]);
@MANY@    const [, ...lightmaps] = await Promise.all([loaded, ...Array.from(
@MANY@        { length: @PAGES@ }, (_, page) => loadHalfFloats(pc, app.graphicsDevice, `${folder}lightmap.${page}.ktx2`))]);
    for (const { resource: texture } of asset.resource.textures) texture.anisotropy = 16;
    for (const { resource: material } of asset.resource.materials) { // in glTF the alpha of COLOR_0 counts, too
        material.opacityVertexColor = true;
        material.opacityVertexColorChannel = 'a';
        material.update();
    }
@ONE@    for (const material of lit) {
@ONE@        material.lightMap = lightmap;
@MANY@    for (const [material, page] of lit) {
@MANY@        material.lightMap = lightmaps[page];
        material.lightMapUv = 1; // TEXCOORD_1
        material.update();
    }
    const entity = asset.resource.instantiateRenderEntity();
    app.root.addChild(entity);
    return entity;
}
