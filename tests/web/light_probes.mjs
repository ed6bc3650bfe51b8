// Reads light probes as three.js and a reader of KTX 2.0 do, and prints what they say as JSON.
//
//     node light_probes.mjs PROBES.three.json VOLUME.ktx2
//
// { probes: [{ position, inside, irradiance: [[r, g, b] per normal] }], normals, volume: { width, height, depth, format, texels } }:
// irradiance by LightProbe.sh.getIrradianceAt, texels as numbers, row by row and slice by slice, four to a texel.
import { readFile } from 'node:fs/promises';
import { DataUtils, ObjectLoader, Vector3 } from 'three';
import { read } from 'three/examples/jsm/libs/ktx-parse.module.js';

const [probesFile, volumeFile] = process.argv.slice(2);
const normals = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1], [0.48, 0.6, 0.64]];
const group = new ObjectLoader().parse(JSON.parse(await readFile(probesFile, 'utf8')));
const probes = group.children.map((probe) => {
    if (!probe.isLightProbe) throw new Error(`${probe.name} is no light probe`);
    return {
        position: probe.position.toArray(),
        inside: probe.userData.inside,
        irradiance: normals.map((n) => probe.sh.getIrradianceAt(new Vector3(...n), new Vector3()).toArray()),
    };
});
const texture = read(new Uint8Array(await readFile(volumeFile)));
const level = texture.levels[0].levelData;
const words = new Uint16Array(level.buffer.slice(level.byteOffset, level.byteOffset + level.byteLength));
console.log(JSON.stringify({
    probes, normals,
    volume: {
        width: texture.pixelWidth, height: texture.pixelHeight, depth: texture.pixelDepth, format: texture.vkFormat,
        texels: Array.from(words, (word) => DataUtils.fromHalfFloat(word)),
    },
}));
