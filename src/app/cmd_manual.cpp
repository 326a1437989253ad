// `tarn manual` — manual pages and shell completion, written from the options themselves so that
// they cannot differ from them. Run by the build; not shown in the help.
#include "app/command.hpp"
#include "app/console.hpp"
#include "core/text.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

namespace tarn::app {

namespace {

/// Text as roff takes it.
std::string roff(const std::string& words) {
    std::string out;
    for (const char c : words) {
        if (c == '\\')
            out += "\\\\";
        else if (c == '-')
            out += "\\-";
        else if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n'))
            out += std::string("\\&") + c;
        else
            out += c;
    }
    return out;
}

std::vector<CLI::App*> shown(CLI::App& app) {
    std::vector<CLI::App*> out;
    for (CLI::App* c : app.get_subcommands([](CLI::App*) { return true; }))
        if (!c->get_group().empty())
            out.push_back(c);
    return out;
}

std::string page(CLI::App& command, const std::string& name, const std::string& usage) {
    std::string out = ".TH " + name + " 1 \"\" \"tarn " TARN_VERSION "\" \"tarn\"\n.SH NAME\n" +
                      roff(name) + " \\- " + roff(command.get_description()) + "\n.SH SYNOPSIS\n" +
                      usage + "\n.SH OPTIONS\n";
    for (const CLI::Option* option : command.get_options()) {
        if (option->get_group().empty())
            continue;
        out += ".TP\n.B " + roff(option->get_name(false, true));
        if (option->get_type_size() != 0)
            out += roff(" " + option->get_type_name());
        out += "\n" + roff(option->get_description());
        if (!option->get_default_str().empty())
            out += roff(" [" + option->get_default_str() + "]");
        out += "\n";
    }
    if (!command.get_footer().empty())
        out += ".SH EXAMPLES AND NOTES\n.nf\n" + roff(command.get_footer()) + "\n.fi\n";
    return out;
}

std::string bash(CLI::App& app) {
    std::string commands, cases;
    for (CLI::App* c : shown(app)) {
        commands += (commands.empty() ? "" : " ") + c->get_name();
        std::string options;
        for (const CLI::Option* option : c->get_options())
            for (const std::string& name : option->get_lnames())
                options += " --" + name;
        cases += "        " + c->get_name() + ") options=\"" + options.substr(1) + "\" ;;\n";
    }
    return "# bash completion for tarn\n"
           "_tarn() {\n"
           "    local word=\"${COMP_WORDS[COMP_CWORD]}\" options=\"\"\n"
           "    if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
           "        COMPREPLY=($(compgen -W \"" +
           commands +
           " --help --version\" -- \"$word\"))\n"
           "        return\n"
           "    fi\n"
           "    case \"${COMP_WORDS[1]}\" in\n" +
           cases +
           "    esac\n"
           "    case \"$word\" in\n"
           "        -*) COMPREPLY=($(compgen -W \"$options\" -- \"$word\")) ;;\n"
           "        *) COMPREPLY=($(compgen -f -- \"$word\")) ;;\n"
           "    esac\n"
           "}\n"
           "complete -o filenames -F _tarn tarn\n";
}

int run_manual(CLI::App& app, const std::string& folder) {
    const std::filesystem::path to(folder);
    std::filesystem::create_directories(to);
    std::string all, see;
    for (CLI::App* c : shown(app)) {
        const std::string name = "tarn-" + c->get_name();
        all += ".TP\n.B tarn " + roff(c->get_name()) + "\n" + roff(c->get_description()) + "\n";
        see += ".BR " + roff(name) + " (1)\n";
        write_beside((to / (name + ".1")).string(),
                     page(*c, name, ".B tarn " + roff(c->get_name()) + "\n[options] ...") +
                         ".SH SEE ALSO\n.BR tarn (1)\n");
    }
    write_beside((to / "tarn.1").string(),
                 page(app, "tarn", ".B tarn\n.I command\n[options] ...") + ".SH COMMANDS\n" + all +
                     ".SH EXIT STATUS\n0 done, 1 failed, 2 wrong usage\n.SH SEE ALSO\n" + see);
    write_beside((to / "tarn.bash").string(), bash(app));
    return 0;
}

} // namespace

void add_manual(CLI::App& app, Run& run) {
    auto folder = std::make_shared<std::string>();
    CLI::App* c = app.add_subcommand("manual", "write manual pages and shell completion");
    c->add_option("FOLDER", *folder, "to write to")->required();
    c->group(""); // for the build
    c->callback(
        [folder, &app, &run] { run = [folder, &app] { return run_manual(app, *folder); }; });
}

} // namespace tarn::app
