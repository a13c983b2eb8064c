"""Completion of the programs' command lines for bash and zsh."""

# Arguments that name something on the disk.
OF_FILES = ("FILE", "DIR", "FOLDER", "PATH")

BASH = """\
# bash completion for {program}
_{function}() {{
  local word="${{COMP_WORDS[COMP_CWORD]}}" before="${{COMP_WORDS[COMP_CWORD-1]}}" at={program} i
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; i++)); do
    case "$at ${{COMP_WORDS[i]}}" in
      {paths}) at+=" ${{COMP_WORDS[i]}}" ;;
    esac
  done
  case "$at $before" in
{values}
    *) ;;
  esac
  local words=
  case "$at" in
{words}
  esac
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}}
complete -o default -F _{function} {program}
"""


def _all(command):
    yield command
    for each in command.commands:
        yield from _all(each)


def _names(command):
    return [name for option in command.options for name in option.names if name.startswith("--")]


def bash(program):
    """The script for one program. A value that is none of a few words is completed as a file's name."""
    values, words, paths = [], [], []
    for command in _all(program):
        at = " ".join(command.words)
        if command is not program:
            paths.append(f'"{at}"')
        for option in command.options:
            for name in option.names if option.takes else ():
                answer = f'mapfile -t COMPREPLY < <(compgen -W "{" ".join(option.choices)}" -- "$word"); '
                values.append(f'    "{at} {name}") {answer if option.choices else ""}return ;;')
        known = [each.words[-1] for each in command.commands] + _names(command)
        words.append(f'    "{at}") words="{" ".join(known)}" ;;')
    return BASH.format(
        program=program.words[0],
        function=program.words[0].replace("-", "_"),
        # A pattern that no word matches, where there are no commands.
        paths=" | ".join(paths or ['""']),
        values="\n".join(values),
        words="\n".join(words),
    )


def _zsh_text(text):
    text = text.split("\n")[0].replace('"', "")
    for sign in "\\[]:'":
        text = text.replace(sign, "'\\''" if sign == "'" else "\\" + sign)
    return text


def _zsh_specification(option):
    about = _zsh_text(option.about)
    value = ""
    if option.choices:
        value = f":{option.value}:({' '.join(option.choices)})"
    elif option.takes:
        value = f":{_zsh_text(option.value)}:{'_files' if option.form == 'TEXT' else ' '}"
    several = "*" if option.several else ""
    return " ".join(f"'{several}{name}[{about}]{value}'" for name in option.names if name.startswith("--"))


def _zsh_argument(place, option):
    """An argument without a flag; what names nothing on the disk is completed as nothing."""
    action = "_files" if option.value in OF_FILES else " "
    return f"'{'*' if option.several else place}:{_zsh_text(option.position)}:{action}'"


def _zsh_function(command):
    name = "_" + "_".join(command.words).replace("-", "_")
    specifications = [_zsh_specification(option) for option in command.options]
    specifications += [_zsh_argument(place, option) for place, option in enumerate(command.positions, 1)]
    lines = [f"{name}() {{", "  local context state line", "  _arguments -C \\"]
    if not command.commands:
        return "\n".join([*lines, *(f"    {each} \\" for each in specifications), "    && return 0", "}"])
    words = " ".join(f'{each.words[-1]}\\:"{_zsh_text(each.about)}"' for each in command.commands)
    specifications += [f"'1:command:(({words}))'", "'*::argument:->rest'"]
    lines += [*(f"    {each} \\" for each in specifications), "    && return 0"]
    lines += ['  [[ "$state" == rest ]] || return 1', '  case "$line[1]" in']
    for each in command.commands:
        lines.append(f"    {each.words[-1]}) _{'_'.join(each.words).replace('-', '_')} ;;")
    return "\n".join([*lines, "  esac", "}"])


def zsh(program):
    """The same for zsh, a function for each command."""
    head = f"#compdef {program.words[0]}\n"
    last = "_" + program.words[0].replace("-", "_") + ' "$@"\n'
    return head + "\n".join(_zsh_function(each) for each in _all(program)) + "\n" + last
