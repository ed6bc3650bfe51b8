// Unpacks what the page shows: the README of the program's folder app/export/web describes the form.
'use strict';
const relume = {};

relume.unpack = async function (base64) {
    const magic = 'RLMWEB01';
    const letters = atob(base64);
    const packed = new Uint8Array(letters.length);
    for (let i = 0; i < packed.length; ++i) packed[i] = letters.charCodeAt(i);
    if (typeof DecompressionStream === 'undefined')
        throw new Error('This browser cannot unpack the page: take one of 2023 or newer.');
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
    const plain = new Uint8Array(await new Response(stream).arrayBuffer());
    if (new TextDecoder().decode(plain.subarray(0, 8)) !== magic)
        throw new Error('The page\'s data are of another version: export it again.');
    const length = new DataView(plain.buffer).getUint32(8, true);
    const header = JSON.parse(new TextDecoder().decode(plain.subarray(12, 12 + length)));
    const first = 12 + length;

    // Returns the bytes of a section. Those of values were sorted: first bytes first.
    function bytesOf(number) {
        const { offset, bytes, stride } = header.sections[number];
        const from = plain.subarray(first + offset, first + offset + bytes);
        if (stride === 1) return from.slice();
        const to = new Uint8Array(bytes);
        const count = bytes / stride;
        for (let k = 0; k < stride; ++k)
            for (let i = 0; i < count; ++i) to[i * stride + k] = from[k * count + i];
        return to;
    }
    return {
        header,
        bytes: bytesOf,
        floats: (number) => new Float32Array(bytesOf(number).buffer),
        words: (number) => new Uint32Array(bytesOf(number).buffer),
        picture: (number) => new Blob([bytesOf(number)], { type: 'image/webp' }),
    };
};
