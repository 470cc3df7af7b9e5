#include "image/spectral_channel.h"

#include <gtest/gtest.h>

namespace latent::image {
namespace {

TEST(SpectralChannel, NamesHoldAWavelengthInAnyUnit) {
    const std::pair<const char*, double> names[] = {{"S0.550nm", 550},        {"S0.550,000nm", 550},     {"S0.550.5nm", 550.5},
                                                    {"S0.0,55um", 550},       {"S0.5,5E-7m", 550},       {"S0.0,00055mm", 550},
                                                    {"S0.550000pm", 550},     {"S0.374,688nm", 374.688}, {"S0.545,0772THz", 550.0},
                                                    {"S0.5,450772E14Hz", 550}};
    for (const auto& [name, nm] : names) {
        ASSERT_TRUE(emitted_wavelength_nm(name)) << name;
        EXPECT_NEAR(*emitted_wavelength_nm(name), nm, 1e-4) << name;
    }
}

TEST(SpectralChannel, OtherNamesHoldNone) {
    for (const char* name : {"", "S0", "S0.", "S0.nm", "S0.550", "S0.-550nm", "S0.0nm", "S0.550 nm", "S0.1,2,3nm", "S0.550xm",
                             "S0.1e400nm", "S1.550nm", "T.550nm", "R", "S0.weight", "550nm"})
        EXPECT_FALSE(emitted_wavelength_nm(name)) << name;
    EXPECT_TRUE(is_reflectance("T.550,000nm"));
    EXPECT_FALSE(is_reflectance("T.transparency"));
    EXPECT_FALSE(is_reflectance("S0.550nm"));
}

}  // namespace
}  // namespace latent::image
