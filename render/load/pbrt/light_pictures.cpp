#include "render/load/pbrt/light_pictures.h"

#include <fmt/format.h>

#include "render/load/files/lat_long.h"
#include "render/load/files/pictures.h"

namespace latent::render {

std::shared_ptr<const ImageDescription> read_light_picture(const ParameterList& list, const std::string& name, SceneFiles& files) {
    Result<LoadedPicture> picture = read_picture(files.resolve(name), files.resolve(name).string());
    if (!picture) {
        list.error(picture.error().message);
        return nullptr;
    }
    if (picture->refused > 0) list.warn(fmt::format("{}: {} negative or non-finite values count as 0", name, picture->refused));
    return std::make_shared<const ImageDescription>(std::move(picture->image));
}

std::shared_ptr<const ImageDescription> read_environment(const ParameterList& list, const std::string& name, SceneFiles& files) {
    std::shared_ptr<const ImageDescription> image = read_light_picture(list, name, files);
    if (!image || (image->width > 0 && image->width == image->height)) return image;
    if (is_lat_long(*image)) return std::make_shared<const ImageDescription>(equal_area_from_lat_long(*image));
    list.error(fmt::format(
        "{}: {} x {} is neither square (an equal-area octahedral mapping) nor twice as wide as high (longitude and latitude)", name,
        image->width, image->height));
    return nullptr;
}

}  // namespace latent::render
