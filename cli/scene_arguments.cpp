#include <carom/cli/scene_arguments.hpp>

#include <carom/cli/choice.hpp>
#include <carom/cli/make_executor.hpp>

#include <carom/core/types.hpp>

#include <fmt/format.h>

#include <charconv>
#include <limits>
#include <utility>

namespace carom::cli {
namespace {

constexpr std::uint64_t kMostSteps = 1'000'000'000;

Result<std::map<std::string, std::string>> key_values(const std::vector<std::string>& settings) {
    std::map<std::string, std::string> out;
    for (const std::string& text : settings) {
        const std::size_t equals = text.find('=');
        if (equals == 0 || equals == std::string::npos) {
            return Error{ErrorCode::Parse, fmt::format("\"{}\" is not of the form KEY=VALUE", text), "--set"};
        }
        const std::string key = text.substr(0, equals);
        if (!out.emplace(key, text.substr(equals + 1)).second) {
            return Error{ErrorCode::InvalidArgument, fmt::format("\"{}\" is set twice", key), "--set"};
        }
    }
    return out;
}

Choices<BroadphaseMethod> broadphase_choices() {
    Choices<BroadphaseMethod> choices{{to_string(BroadphaseMethod::Automatic), BroadphaseMethod::Automatic}};
    for (const BroadphaseMethod method : kBroadphaseMethods) choices.push_back({to_string(method), method});
    return choices;
}

Choices<ContactMethod> contact_method_choices() {
    Choices<ContactMethod> choices;
    for (const ContactMethod method : {ContactMethod::Automatic, ContactMethod::Soft, ContactMethod::Direct, ContactMethod::Impulses}) choices.push_back({to_string(method), method});
    return choices;
}

Error with_known_names(Error error, const SceneArguments& arguments) {
    if (error.code == ErrorCode::UnknownName && error.where == "scene") {
        std::string names;
        for (const scenes::SceneInfo& info : scenes::catalogue()) {
            names += (names.empty() ? "" : ", ") + info.name;
        }
        error.message = fmt::format("no scene is called \"{}\"; there are {}", arguments.scene, names);
    }
    return error;
}

}  // namespace

bool is_path(const std::string& scene) { return scene.ends_with(".json") || scene.find('/') != std::string::npos; }

CLI::Validator whole_number(std::int64_t lower, std::uint64_t upper) {
    return {[=](std::string& text) -> std::string {
                const char* end = text.data() + text.size();
                std::uint64_t value = 0;
                const std::from_chars_result parsed = std::from_chars(text.data(), end, value);
                const bool good = !text.empty() && parsed.ec == std::errc{} && parsed.ptr == end;
                if (!good || value > upper || (lower > 0 && value < static_cast<std::uint64_t>(lower))) {
                    return fmt::format("\"{}\" is not a whole number in {}..{}", text, lower, upper);
                }
                return {};
            },
            ""};
}

void SceneArguments::add_to(CLI::App& command) {
    command.add_option("SCENE", scene, "a scene's name (see carom list) or a scene file (.json)")->required();
    command.add_option("--bodies", bodies, "dynamic bodies; what is not given comes from the scene")
        ->check(whole_number(0, scenes::kMaxSceneBodies));
    command.add_option("--steps", steps, "steps")->check(whole_number(0, kMostSteps));
    command.add_option("--dt", dt, "length of a step [s], > 0");
    command.add_option("--substeps", substeps, "substeps per step, 1..1024")->check(whole_number(1, 1024));
    command.add_option("--threads", threads, "threads; results do not depend on it")->check(whole_number(1, 256));
    command.add_option("--seed", seed, "seed of the scene's random stream")
        ->check(whole_number(0, std::numeric_limits<std::uint64_t>::max()));
    command.add_option("--contact-reuse", contact_reuse, "share of a shape's smallest extent by which two may move before their contact is found anew, 0..0.1; 0: every step");
    add_choice(command, "--contact-method", contact_method, contact_method_choices(), "who solves the contacts: soft, direct, or direct where soft ones would sag too far");
    command.add_option("--direct-sag", direct_sag, "share of the smallest extent by which a point may sag where it is solved directly, 1e-6..0.01");
    command.add_option("--direct-budget", direct_budget, "products of 6 x 6 blocks that a factorisation of an island may take")
        ->check(whole_number(0, std::uint64_t{1} << 32));
    add_choice(command, "--broadphase-method", broadphase, broadphase_choices(), "who finds the pairs; results do not depend on it");
    command.add_flag("--no-continuous", discrete, "bodies are not followed between the start of a step and its end: what is fast may pass through others");
    command.add_flag("--sleep", sleep, "islands of bodies that have come to rest sleep until something wakes them");
    command.add_option("--set", set, "a parameter that the scene declares, KEY=VALUE; may be repeated")
        ->take_all()
        ->allow_extra_args(false);
}

Result<LoadedScene> SceneArguments::load() const {
    if (dt && !is_finite(*dt)) {
        return Error{ErrorCode::NotFinite, "must be a finite number", "--dt"};
    }
    if (dt && *dt <= 0.0) {
        return Error{ErrorCode::InvalidArgument, fmt::format("must be positive, not {}", *dt), "--dt"};
    }
    if (contact_reuse && !(*contact_reuse >= 0.0 && *contact_reuse <= 0.1)) {
        return Error{ErrorCode::InvalidArgument, fmt::format("must lie in 0..0.1, not {}", *contact_reuse), "--contact-reuse"};
    }
    if (direct_sag && !(*direct_sag >= 1e-6 && *direct_sag <= 0.01)) {
        return Error{ErrorCode::InvalidArgument, fmt::format("must lie in 1e-6..0.01, not {}", *direct_sag), "--direct-sag"};
    }
    Result<std::map<std::string, std::string>> settings = key_values(set);
    if (!settings) return settings.error();
    Result<std::unique_ptr<Executor>> executor = make_executor(threads);
    if (!executor) return executor.error();

    scenes::SceneOptions options;
    options.bodies = bodies;
    options.seed = seed;
    options.substeps = substeps;
    options.set = *settings;
    options.world.executor = executor->get();
    options.world.broadphase = broadphase;
    options.world.sleep.enabled = sleep;
    options.world.continuous.enabled = !discrete;
    options.world.record_paths = record_paths;
    options.world.contact_method = contact_method;
    options.world.direct_sag = direct_sag.value_or(options.world.direct_sag);
    options.world.direct_budget = direct_budget.value_or(options.world.direct_budget);
    options.world.contact_reuse = contact_reuse.value_or(options.world.contact_reuse);
    Result<scenes::SceneRun> run = is_path(scene) ? scenes::read_scene(scene, options) : scenes::make_scene(scene, options);
    if (!run) return with_known_names(run.error(), *this);
    run->steps = steps.value_or(run->steps);
    run->dt = dt.value_or(run->dt);
    return LoadedScene{std::move(*executor), std::move(*run)};
}

}  // namespace carom::cli
