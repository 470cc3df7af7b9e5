#include "base/recipe_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <vector>

#include "base/near_names.h"
#include "base/option_parts.h"

namespace latent::cli {

namespace {

bool is_recipe_section(const CLI::App* app) { return app->get_name().empty(); }

std::string key_of(const CLI::Option& option) { return option.get_lnames().front(); }

CLI::ValidationError refused(const std::string& place, const std::string& why) {
    return CLI::ValidationError("--recipe", place + ": " + why);
}

bool is_flag(const CLI::Option& option) { return option.get_items_expected_max() == 0; }

// "--denoise", which may have a value.
bool is_flag_of_numbers(const CLI::Option& option) {
    const std::string plain = is_flag(option) ? option.get_flag_value(key_of(option), "") : "true";
    return plain != "true" && plain != "false";
}

// A flag that can also be turned off: "--grain,!--no-grain".
bool is_switch(const CLI::Option& option) {
    return is_flag(option) && option.get_lnames().size() > 1 && !option.get_fnames().empty();
}

bool is_list(const CLI::Option& option) { return option.get_items_expected_max() > 1; }

// As on a command line.
std::string text_of(const Recipe& scalar) { return scalar.is_string() ? scalar.get<std::string>() : scalar.dump(); }

Recipe scalar_of(const std::string& text) {
    const Recipe number = Recipe::parse(text, nullptr, false);
    return number.is_number() && number.dump() == text ? number : Recipe(text);
}

// Why this option cannot have that value; "" if it can.
std::string_view objection(const CLI::Option& option, const Recipe& value) {
    if (is_flag_of_numbers(option)) return value.is_boolean() || value.is_number() ? "" : "must be true, false or a number";
    if (is_flag(option)) return value.is_boolean() ? "" : "must be true or false";
    if (is_list(option)) return value.is_boolean() ? "must be a text, or a list of texts" : "";
    return value.is_string() || value.is_number() ? "" : "must be a text or a number";
}

void set(CLI::Option& option, const Recipe& value) {
    const auto add = [&option](const Recipe& item) {
        if (!item.is_boolean())
            option.add_result(text_of(item));
        else if (item.get<bool>())
            option.add_result(option.get_flag_value(key_of(option), ""));
        else
            option.add_result(is_flag_of_numbers(option) ? "0" : "false");
    };
    if (value.is_array())
        std::ranges::for_each(value, add);
    else
        add(value);
    option.run_callback();
}

// Whether the command line excludes the option, or one that it needs.
bool gives_way(const CLI::Option& option, const std::set<const CLI::Option*>& given) {
    const auto is_given = [&given](const CLI::Option* other) { return given.count(other) > 0; };
    return std::ranges::any_of(option.get_excludes(), is_given) ||
           std::ranges::any_of(option.get_needs(),
                               [&](const CLI::Option* other) { return !is_given(other) && gives_way(*other, given); });
}

void apply(const std::string& place, CLI::App& section, const Recipe& values) {
    std::set<const CLI::Option*> given;
    std::vector<std::string> keys;
    for (const CLI::Option* option : section.get_options()) {
        keys.push_back(key_of(*option));
        if (option->count() > 0) given.insert(option);
    }
    for (const CLI::Option* option : section.get_parent()->get_options()) {
        if (option->count() > 0) given.insert(option);
    }
    for (const auto& [key, value] : values.items()) {
        const std::string name = section.get_group() + "." + key;
        if (std::ranges::find(keys, key) == keys.end()) {
            const std::string near = near_names(key, keys);
            throw refused(place, fmt::format("{}: unknown key{}", name, near.empty() ? "" : "; did you mean " + near + "?"));
        }
        CLI::Option& option = *section.get_option("--" + key);
        if (const std::string_view why = objection(option, value); !why.empty())
            throw refused(place, fmt::format("{}: {}", name, why));
        const bool is_empty = value.is_array() && value.empty();
        if (is_empty || given.count(&option) > 0 || gives_way(option, given)) continue;
        try {
            set(option, value);
        } catch (const CLI::ParseError& error) {
            throw refused(place, in_plain_words(error));
        }
    }
}

// "films/mine/NAME" of an option "FOLDER/NAME" becomes "mine/NAME", "tables/eye.csv" of one "NAME|FILE.csv" becomes "eye.csv".
std::string without_folders(const CLI::Option& option, const std::string& text) {
    const std::string type = option.get_type_name();
    std::size_t slash = text.rfind('/');
    if (type.find("FOLDER/") != std::string::npos && slash != std::string::npos && slash > 0)
        slash = text.rfind('/', slash - 1);
    else if (type.find("FILE") == std::string::npos)
        return text;
    return slash == std::string::npos ? text : text.substr(slash + 1);
}

Recipe type_schema(const Recipe& type) {
    Recipe schema;
    schema["type"] = type;
    return schema;
}

// What one value of the option may be.
Recipe scalar_schema(const CLI::Option& option) {
    if (is_flag_of_numbers(option)) return type_schema(Recipe::array({"boolean", "number"}));
    if (is_flag(option)) return type_schema("boolean");
    const std::string type = option.get_type_name();
    const std::size_t begin = type.find(":{");  // where the list of CLI::IsMember begins
    if (begin == std::string::npos) return type_schema(Recipe::array({"string", "number"}));
    Recipe schema;
    const std::string words = type.substr(begin + 2, type.find('}', begin) - begin - 2);
    for (const std::string_view word : parts_of(words, ',')) {
        schema["enum"].push_back(word);
        if (const Recipe number = scalar_of(std::string(word)); number.is_number()) schema["enum"].push_back(number);
    }
    return schema;
}

Recipe schema_of(const CLI::Option& option) {
    Recipe schema;
    schema["description"] = option.get_description();
    const Recipe scalar = scalar_schema(option);
    if (is_list(option)) {
        Recipe list = type_schema("array");
        list["items"] = scalar;
        schema["anyOf"] = Recipe::array({scalar, list});
    } else {
        schema.update(scalar);
    }
    if (const std::string usual = option.get_default_str(); !usual.empty()) schema["default"] = scalar_of(usual);
    return schema;
}

// An object may have these members and no others.
Recipe object_schema(const Recipe& members) {
    Recipe schema = type_schema("object");
    schema["additionalProperties"] = false;
    schema["properties"] = members;
    return schema;
}

}  // namespace

CLI::App& add_section(CLI::App& app, const std::string& name) {
    CLI::App& section = *app.add_option_group(name);
    section.set_help_flag();  // that of the app serves for all
    return section;
}

void apply_recipe(CLI::App& app, const std::string& place, const Recipe& recipe) {
    for (CLI::App* section : app.get_subcommands(is_recipe_section)) {
        if (const auto values = recipe.find(section->get_group()); values != recipe.end()) apply(place, *section, *values);
    }
}

void add_recipe(CLI::App& app) {
    const auto read = [&app](const std::string& path) {
        const Result<Recipe> recipe = read_recipe(path);
        if (!recipe) throw CLI::ValidationError("--recipe", recipe.error().message);
        apply_recipe(app, path, *recipe);
    };
    app.add_option_function<std::string>("--recipe", read,
                                         "decisions from a file: a recipe (JSON), or a print, which holds its own; options of the "
                                         "command line win")
        ->type_name("FILE");
}

Recipe recipe_of(const CLI::App& section) {
    Recipe values = Recipe::object();
    for (const CLI::Option* option : section.get_options()) {
        if (option->count() == 0) continue;
        std::vector<std::string> texts = option->reduced_results();
        for (std::string& text : texts) text = without_folders(*option, text);
        Recipe value = scalar_of(texts.front());
        if (is_flag(*option) && !is_flag_of_numbers(*option)) value = CLI::detail::to_flag_value(texts.front()) > 0;
        if (is_list(*option)) value = texts;
        const bool usual = is_flag(*option) ? value == false && !is_switch(*option) : texts.front() == option->get_default_str();
        if (!usual) values[key_of(*option)] = value;
    }
    Recipe recipe;
    recipe[section.get_group()] = values;
    return recipe;
}

Recipe recipe_schema(const std::vector<const CLI::App*>& sections) {
    Recipe members;
    members["$schema"] = type_schema("string");
    members["latent-recipe"]["const"] = kRecipeVersion;
    for (const CLI::App* section : sections) {
        Recipe keys = Recipe::object();
        for (const CLI::Option* option : section->get_options()) keys[key_of(*option)] = schema_of(*option);
        members[section->get_group()]["description"] = "options of latent-" + section->get_group();
        members[section->get_group()].update(object_schema(keys));
    }
    Recipe schema;
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
    schema["title"] = "Recipe of a picture and its print, for Latent";
    schema.update(object_schema(members));
    schema["required"] = Recipe::array({"latent-recipe"});
    return schema;
}

}  // namespace latent::cli
