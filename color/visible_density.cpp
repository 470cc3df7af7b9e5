#include "color/visible_density.h"

#include <cmath>

#include "color/spectrum.h"

namespace latent::color {
namespace {

constexpr double kSteepness = 0.0072, kMidpoint = 538;

double tanh_at(double lambda_nm) { return std::tanh(kSteepness * (lambda_nm - kMidpoint)); }
// The integral of 1/cosh^2 over the range, times the steepness.
const double kSpan = tanh_at(kLambdaMax) - tanh_at(kLambdaMin);

}  // namespace

double visible_pdf_lambda(double lambda_nm) {
    if (!(lambda_nm >= kLambdaMin && lambda_nm <= kLambdaMax)) return 0;
    const double c = std::cosh(kSteepness * (lambda_nm - kMidpoint));
    return kSteepness / (kSpan * c * c);
}

double visible_cdf(double lambda_nm) {
    if (lambda_nm <= kLambdaMin) return 0;
    if (lambda_nm >= kLambdaMax) return 1;
    return (tanh_at(lambda_nm) - tanh_at(kLambdaMin)) / kSpan;
}

}  // namespace latent::color
