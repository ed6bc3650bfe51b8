#pragma once

#include "assets/model/scene.h"

// These are the town's textures, painted by arithmetic. All but the last three repeat without a seam.
namespace relume::generate {

Image plasterPicture(const glm::vec3& color, uint32_t seed); // sRGB encoded, with stains
Image ashlarPicture();                                       // four courses of cut stone
Image brickPicture();                                        // eight courses
Image cobblePicture();                                       // setts in rows
Image flagPicture();                                         // large slabs
Image rooftilePicture();                                     // eight rows of tiles
Image boardPicture(const glm::vec3& color);                  // four planks
Image stripePicture();                                       // canvas
Image bookPicture();                                         // the backs of a shelf of books
Image grillePicture();                                       // bars and scrolls, masked
Image rugPicture();
Image leafPicture();   // a branch, masked
Image ivyPicture();    // leaves that cover more, masked
Image flowerPicture(); // red flowers among leaves, masked

} // namespace relume::generate
