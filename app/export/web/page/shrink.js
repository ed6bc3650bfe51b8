// Makes pictures smaller for devices that take none so large. UVs stretch a picture anyway, so a side that is too long is cut by
// itself.
'use strict';
relume.shrink = (function () {
    // Tells which pixels of a longer side those of a shorter one cover: pixel i those from first[i] to last[i], of which the two
    // at the ends have weights of their own. Weights sum up to 1. In units of 1 / to of a pixel all bounds are whole numbers.
    function covers(from, to) {
        const first = new Uint32Array(to), last = new Uint32Array(to);
        const atFirst = new Float64Array(to), atLast = new Float64Array(to);
        for (let i = 0; i < to; ++i) {
            const begin = i * from, end = begin + from;
            first[i] = Math.floor(begin / to);
            last[i] = Math.floor((end - 1) / to);
            atFirst[i] = first[i] === last[i] ? 1 : ((first[i] + 1) * to - begin) / from;
            atLast[i] = (end - last[i] * to) / from;
        }
        const weight = (i, at) => (at === first[i] ? atFirst[i] : at === last[i] ? atLast[i] : to / from);
        return { first, last, weight };
    }

    const exponents = Float64Array.from({ length: 32 }, (_, bits) => 2 ** (bits - 24)); // what a mantissa of 1 stands for
    // Packs a colour into RGB9E5, as the program does.
    function packed(red, green, blue) {
        const most = Math.max(red, green, blue);
        if (!(most > 0)) return 0;
        let bits = Math.max(Math.floor(Math.log2(most)), -16) + 16;
        if (Math.round(most / exponents[bits]) > 511) ++bits; // rounded up, it may need one bit more
        const of = (value) => Math.round(value / exponents[bits]);
        return ((bits << 27) | (of(blue) << 18) | (of(green) << 9) | of(red)) >>> 0;
    }

    // Returns a sky's picture in RGB9E5 with at most `most` pixels along each side, each the mean of the area that it covers.
    function sky(words, width, height, most) {
        if (Math.max(width, height) <= most) return { words, width, height };
        const small = { width: Math.min(width, most), height: Math.min(height, most) };
        small.words = new Uint32Array(small.width * small.height);
        const columns = covers(width, small.width), rows = covers(height, small.height);
        for (let y = 0; y < small.height; ++y)
            for (let x = 0; x < small.width; ++x) {
                let red = 0, green = 0, blue = 0;
                for (let row = rows.first[y]; row <= rows.last[y]; ++row)
                    for (let column = columns.first[x]; column <= columns.last[x]; ++column) {
                        const word = words[row * width + column];
                        const scale = rows.weight(y, row) * columns.weight(x, column) * exponents[word >>> 27];
                        red += scale * (word & 511);
                        green += scale * (word >>> 9 & 511);
                        blue += scale * (word >>> 18 & 511);
                    }
                small.words[y * small.width + x] = packed(red, green, blue);
            }
        return small;
    }

    // Decodes a texture's picture, with at most `most` pixels along each side.
    async function texture(picture, most) {
        const options = { premultiplyAlpha: 'none', colorSpaceConversion: 'none' };
        const whole = await createImageBitmap(picture, options);
        if (Math.max(whole.width, whole.height) <= most) return whole;
        const small = await createImageBitmap(picture, { ...options, resizeQuality: 'high',
            resizeWidth: Math.min(whole.width, most), resizeHeight: Math.min(whole.height, most) });
        whole.close();
        return small;
    }
    return { sky, texture };
})();
