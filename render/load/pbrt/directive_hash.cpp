#include "render/load/pbrt/directive_hash.h"

#include "color/named_spectra.h"

namespace latent::render {

void count(const Directive& directive, SceneFiles& files) {
    files.count(directive.name);
    files.count(static_cast<double>(directive.strings.size()));
    for (const std::string& s : directive.strings) files.count(s);
    files.count(static_cast<double>(directive.numbers.size()));
    for (const double x : directive.numbers) files.count(x);
    files.count(static_cast<double>(directive.parameters.size()));
    for (const Parameter& p : directive.parameters) {
        files.count(p.type);
        files.count(p.name);
        files.count(static_cast<double>(p.numbers.size()));
        for (const double x : p.numbers) files.count(x);
        for (const bool x : p.flags) files.count(x ? 1.0 : 0.0);
        for (const std::string& s : p.strings) {
            const bool is_file = p.name == "filename" || (p.type == "spectrum" && !color::named_spectrum(s));
            if (!is_file) files.count(s);
        }
    }
}

}  // namespace latent::render
