# Completion of posefusion for bash: commands and options as the program lists them itself, file names otherwise.
_posefusion() {
    local program=${COMP_WORDS[0]} current=${COMP_WORDS[COMP_CWORD]} command= word words=
    COMPREPLY=()
    for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
        [[ $word == -* ]] || { command=$word; break; }
    done
    if [[ -z $command ]]; then
        words="--help --version $("$program" --help 2>/dev/null |
            awk '/^Subcommands:/ { on = 1; next } !NF { on = 0 } on { print $1 }')"
    elif [[ $current == -* ]]; then
        # those that start a line, and the negations named in the meaning of another
        words=$("$program" "$command" --help-all 2>/dev/null | grep -oE '^  (-h,)?--[a-z0-9-]+|--no-[a-z0-9-]+' |
            grep -oE -- '--[a-z0-9-]+')
    fi
    [[ -z $words ]] || mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
}
complete -o default -F _posefusion posefusion
