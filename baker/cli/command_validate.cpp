#include "baker/cli/arguments.hpp"
#include "baker/cli/commands.hpp"
#include "baker/cli/kinds_report.hpp"
#include "baker/cli/options.hpp"
#include "baker/cli/report.hpp"
#include "baker/file_io.hpp"
#include "format/file.hpp"

namespace dfield::cli {

void add_validate_command(CLI::App& app, ExitCode& exit_code) {
    struct ValidateCommand {
        std::string file, json;
    };
    auto command = std::make_shared<ValidateCommand>();
    CLI::App* validate =
        app.add_subcommand("validate", "Check a .dfield against the format; numbered findings");
    validate->add_option("FILE", command->file, "A .dfield")->required();
    add_json_option(*validate, command->json, "the findings");
    validate->footer(
        "The numbers of findings are listed in format/FORMAT.md. Exit code 6 when there is an error.");
    validate->callback([command, &exit_code] {
        const std::vector<std::byte> bytes = read_file(command->file);
        const std::vector<Finding> findings = validate_file(bytes);
        Json list = Json::array();
        std::size_t errors = 0;
        for (const Finding& finding : findings) {
            const bool error = finding.severity == Finding::Severity::kError;
            errors += error;
            const auto number = static_cast<unsigned>(finding.code);
            list.push_back({{"number", number},
                            {"severity", error ? "error" : "warning"},
                            {"offset", finding.offset},
                            {"message", finding.message}});
            say(command->json,
                text("%s %u at byte %llu: %s", error ? "error" : "warning", number,
                     static_cast<unsigned long long>(finding.offset), finding.message.c_str()));
        }
        if (findings.empty()) say(command->json, command->file + ": valid");
        Json kinds = Json::array();
        if (errors == 0) {
            const DisplacementField field = read_field(bytes);
            const FileInfo info = read_file_info(bytes);
            kinds = kinds_json(field, info);
            for (const KindLine& line : kind_lines(field, info))
                say(command->json, "  " + line.kind + ": " + line.description);
        }
        write_json_report(command->json, {{"file", command->file},
                                          {"valid", errors == 0},
                                          {"errors", errors},
                                          {"warnings", findings.size() - errors},
                                          {"findings", list},
                                          {"kinds", kinds}});
        if (errors) exit_code = ExitCode::kInvalid;
    });
}

}  // namespace dfield::cli
