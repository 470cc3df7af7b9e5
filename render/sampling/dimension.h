// render/sampling/dimension.h: the random decisions of a sample, each by its name.
#pragma once

#include <cstdint>

namespace latent::render {

// What each random decision of a sample is called. Scattering vertices of camera and light subpaths have blocks of their own.
struct Dimension {
    enum : std::uint32_t {
        kXi,
        kKeptWavelength,
        kLensU,
        kLensV,
        // For the ray that a light subpath starts with; the first chooses the light, too.
        kStartU,
        kStartV,
        kStartDirectionU,
        kStartDirectionV,
        // The seed of Random.
        kRandom,
        // Within the shutter's, if anything moves.
        kTime,
        kCameraVertices = 16,
        kLightVertices = 1u << 20
    };
    // Within the block of a vertex.
    enum : std::uint32_t {
        kDistanceChannel,
        kDistance,
        // Which light, and the point on it.
        kLightU,
        kLightV,
        kLobe,
        kDirectionU,
        kDirectionV,
        kSurvival,
        kConnection,
        kEquiangularLight,
        kEquiangular,
        kBlock
    };

    static constexpr std::uint32_t of_camera_vertex(std::uint32_t vertex, std::uint32_t what) {
        return kCameraVertices + vertex * kBlock + what;
    }
    static constexpr std::uint32_t of_light_vertex(std::uint32_t vertex, std::uint32_t what) {
        return kLightVertices + vertex * kBlock + what;
    }
    // The same decision behind that many interfaces, on the line from the vertex before.
    static std::uint64_t behind(std::uint32_t interfaces, std::uint32_t dimension) {
        return (std::uint64_t{interfaces} << 24) + dimension;
    }
};

}  // namespace latent::render
