#include "tests/darkroom/darkroom.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "color/light_spectrum.h"

namespace latent::testing {

Picture read_exr(const std::filesystem::path& path) {
    Imf::InputFile file(path.c_str());
    const Imath::Box2i window = file.header().dataWindow();
    Picture picture{window.max.x - window.min.x + 1, window.max.y - window.min.y + 1, {}};
    const auto width = static_cast<std::size_t>(picture.width), size = width * static_cast<std::size_t>(picture.height);
    Imf::FrameBuffer frame;
    for (auto channel = file.header().channels().begin(); channel != file.header().channels().end(); ++channel) {
        std::vector<float>& values = picture.channels[channel.name()];
        values.resize(size);
        frame.insert(channel.name(), Imf::Slice::Make(Imf::FLOAT, values.data(), window, sizeof(float), width * sizeof(float)));
    }
    file.setFrameBuffer(frame);
    file.readPixels(window.min.y, window.max.y);
    return picture;
}

Mean mean_of(const Picture& picture, const std::string& channel, int x0, int y0, int x1, int y1) {
    double sum = 0, squares = 0;
    for (int y = y0; y < y1; ++y) {
        for (int x = x0; x < x1; ++x) {
            const double value = static_cast<double>(picture.at(channel, x, y));
            sum += value;
            squares += value * value;
        }
    }
    const double n = (x1 - x0) * (y1 - y0), mean = sum / n;
    return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1))};
}

std::string Darkroom::render(const std::string& name, const std::string& scene, const std::vector<std::string>& options) const {
    std::ofstream(folder_ / (name + ".pbrt")) << scene;
    std::vector<std::string> command = {tool("latent-render"), path(name + ".pbrt"), "-o", path(name + ".latent"), "--quiet"};
    command.insert(command.end(), options.begin(), options.end());
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return path(name + ".latent");
}

Picture Darkroom::develop(const std::string& file, const std::vector<std::string>& options, Outcome* outcome) const {
    std::vector<std::string> command = {tool("latent-develop"), file, "-o", path("developed.exr"), "--force", "--quiet"};
    command.insert(command.end(), options.begin(), options.end());
    const Outcome developed = run(command);
    EXPECT_EQ(developed.status, 0) << developed.err;
    if (outcome) *outcome = developed;
    return developed.status == 0 ? read_exr(folder_ / "developed.exr") : Picture{};
}

std::string spectrum_parameter(const std::string& name, const color::Spectrum& spectrum) {
    const auto nm = spectrum.lambda_nm();
    const bool goes_on = spectrum.outside() == color::Outside::kClamped;  // in a scene it ends where its samples do
    std::string text = fmt::format("\"spectrum {}\" [", name);
    if (goes_on && nm.front() > color::kLambdaMin) text += fmt::format(" {} {}", color::kLambdaMin, spectrum.values().front());
    for (std::size_t i = 0; i < nm.size(); ++i) text += fmt::format(" {} {}", nm[i], spectrum.values()[i]);
    if (goes_on && nm.back() < color::kLambdaMax) text += fmt::format(" {} {}", color::kLambdaMax, spectrum.values().back());
    return text + " ]";
}

std::string wall(const std::vector<color::Spectrum>& reflectances, const std::string& lights) {
    std::string scene = R"(Film "rgb" "integer xresolution" 6 "integer yresolution" 4
Integrator "path" "integer maxdepth" 1
LookAt 0 0 0  0 0 1  0 1 0
Camera "perspective" "float fov" 90
WorldBegin
)" + lights;
    for (std::size_t i = 0; i < reflectances.size(); ++i) {
        const double x = -3 + static_cast<double>(i % 6), y = 2 - static_cast<double>(i / 6);
        scene += fmt::format("Material \"diffuse\" {}\n", spectrum_parameter("reflectance", reflectances[i]));
        scene +=
            fmt::format("Shape \"bilinearmesh\" \"point3 P\" [ {0} {1} 2  {2} {1} 2  {0} {3} 2  {2} {3} 2 ]\n", x, y, x + 1, y - 1);
    }
    return scene;
}

std::string distant_light(const std::string& spectrum, double scale) {
    return fmt::format("LightSource \"distant\" {} \"float scale\" {} \"point3 from\" [ 0 0 0 ] \"point3 to\" [ 0 0 1 ]\n",
                       spectrum, std::numbers::pi * scale);
}

color::Xyz seen(const color::Spectrum& patch, const color::Spectrum& light, const color::Observer& observer) {
    const double luminance = color::luminance(light);
    const auto product = [&](double nm) { return patch(nm) * light(nm) / luminance; };
    return color::xyz_from_spectrum(color::Spectrum::from_function(product, color::Outside::kZero), observer);
}

}  // namespace latent::testing
