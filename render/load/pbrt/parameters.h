// render/load/pbrt/parameters.h: the parameter list of one directive: values by name, checked. Parameters that were not read are
// reported.
#pragma once

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/load/files/diagnostics.h"
#include "render/load/pbrt/directive.h"

namespace latent::render {

class ParameterList {
 public:
    // `inherited`: from Attribute directives; those given with the directive itself come first. The directive and `diagnostics`
    // must outlive the list.
    ParameterList(const Directive& directive, const std::vector<Parameter>& inherited, Diagnostics& diagnostics);

    // The parameter of this name if its type is among `types`; it counts as used. Null if there is none.
    const Parameter* find(std::string_view name, std::initializer_list<std::string_view> types) const;

    // One value, or the default. A wrong count of values or a value outside low..high is an error.
    double number(std::string_view name, double otherwise, double low = -1e30, double high = 1e30) const;
    std::optional<double> number(std::string_view name) const;
    std::int64_t integer(std::string_view name, std::int64_t otherwise, std::int64_t low, std::int64_t high) const;
    bool flag(std::string_view name, bool otherwise) const;
    std::optional<std::string> string(std::string_view name) const;
    Vec3d point(std::string_view name, const Vec3d& otherwise) const;
    // All values of an array, in items of `size` numbers; empty if the parameter is not there.
    std::span<const double> array(std::string_view name, std::string_view type, std::size_t size) const;

    // Parameters that change no sample: named in a note at the first of them.
    void ignore(std::initializer_list<std::string_view> names, std::string_view why) const;
    // Those of files/unread.h are named in notes and warnings. Every other parameter that was not read is an error: without it the
    // picture would be wrong, or its name is misspelled.
    void report_unused() const;

    const Directive& directive() const { return directive_; }
    void error(const std::string& message) const { diagnostics_.error(directive_.where, message); }
    void error(const Parameter& parameter, const std::string& message) const {
        diagnostics_.error(parameter.where, parameter.name + ": " + message);
    }
    void unreadable(const Error& file) const { diagnostics_.unreadable(directive_.where, file.message); }
    void warn(const std::string& message) const { diagnostics_.warn(directive_.where, message); }
    void note(const std::string& message) const { diagnostics_.note(directive_.where, message); }

 private:
    template <class F>
    void each(F&& f) const {
        for (const Parameter& p : directive_.parameters) f(p);
        for (const Parameter& p : inherited_) f(p);
    }

    // "; did you mean radius?" or "; its type must be bool", or nothing.
    std::string near_parameters(const Parameter& p) const;

    // A name that was looked for while something was not read: what that may be a misspelling of.
    struct Asked {
        std::string name;
        std::vector<std::string_view> types;
    };

    const Directive& directive_;
    std::vector<Parameter> inherited_;
    mutable std::vector<Asked> asked_;
    Diagnostics& diagnostics_;
};

}  // namespace latent::render
