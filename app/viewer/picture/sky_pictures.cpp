#include "app/viewer/picture/sky_pictures.h"

#include "assets/base/error.h"
#include "assets/images/sky_picture.h"

#include <chrono>
#include <new>
#include <utility>

namespace relume {

SkyPictures::~SkyPictures() {
    if (result_.valid()) result_.wait();
}

void SkyPictures::read(const std::string& file, bool chosen) {
    reading_ = file;
    if (result_.valid())
        next_ = Wish{file, chosen};
    else
        begin({file, chosen});
}

void SkyPictures::begin(Wish wish) {
    result_ = std::async(std::launch::async, [wish = std::move(wish)] {
        Result result;
        result.sky.file = wish.file;
        result.chosen = wish.chosen;
        try {
            readSkyPicture(result.sky);
        } catch (const Error& error) {
            result.error = error.what();
        } catch (const std::bad_alloc&) {
            result.error = wish.file + ": does not fit in memory";
        }
        return result;
    });
}

void SkyPictures::forget() {
    next_.reset();
    reading_.clear();
}

std::optional<SkyPictures::Result> SkyPictures::poll() {
    if (!result_.valid() || result_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
        return std::nullopt;
    Result result = result_.get();
    if (next_) {
        begin(*std::exchange(next_, std::nullopt));
        return std::nullopt;
    }
    if (std::exchange(reading_, {}).empty()) return std::nullopt;
    return result;
}

} // namespace relume
