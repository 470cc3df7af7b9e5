// tools/darkroom/engine/seen_picture.h: a part of the picture, at the size in which it is looked at.
#pragma once

#include <fmt/format.h>

#include <string>

#include "tools/darkroom/engine/decisions.h"
#include "tools/develop/picture/picture.h"

namespace latent::darkroom {

inline constexpr int kBlock = 2048;  // pixels a side that are developed at once

inline develop::PixelRect pixels_of(const image::Rect& r) { return {r.x0, r.y0, r.x1, r.y1}; }

inline std::string text_of(const develop::Size& size) { return fmt::format("{}x{}", size.width, size.height); }

inline image::Rect whole(const develop::Size& size) { return {0, 0, static_cast<int>(size.width), static_cast<int>(size.height)}; }

// What is seen of the decisions, at this size.
inline develop::PictureOptions picture_of(const Decisions& decisions, const develop::Size& size, const image::Rect& block) {
    develop::PictureOptions picture = decisions.picture;
    picture.size = text_of(size);
    picture.crop = pixels_of(block);
    picture.mipmap = picture.zip = false;
    if (decisions.print.layer.empty()) picture.layers = {};
    return picture;
}

}  // namespace latent::darkroom
