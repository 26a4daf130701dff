# completion.awk - bash completion from what --help prints: options of a program, or of a command of one.
#
#   for each: printf 'NAME COMMAND\n' and then the help's lines; COMMAND - for a program without commands
/^@ / {
    key = $2 " " $3
    keys[++count] = key
    next
}
match($0, /^ +(-[a-z], )?--[a-z-]+/) {
    option = substr($0, RSTART, RLENGTH)
    sub(/.*--/, "--", option)
    options[key] = options[key] " " option
    if ($0 ~ /^ +-[a-z], /)
        options[key] = options[key] " " substr($0, match($0, /-[a-z]/), 2)
}
END {
    print "# bash completion of Terraclip; made from the programs' own help"
    print "_terraclip()"
    print "{"
    print "    local word=${COMP_WORDS[COMP_CWORD]} program=${COMP_WORDS[0]##*/} command=-"
    print "    COMPREPLY=()"
    print "    if [ \"$program\" = terraclip ]; then"
    print "        command=${COMP_WORDS[1]}"
    print "        if [ \"$COMP_CWORD\" = 1 ]; then"
    printf "            COMPREPLY=($(compgen -W '"
    for (i = 1; i <= count; i++) {
        split(keys[i], part, " ")
        if (part[1] == "terraclip")
            printf "%s%s", part[2], i < count ? " " : ""
    }
    print "' -- \"$word\"))"
    print "            return"
    print "        fi"
    print "    fi"
    print "    [ \"${word#-}\" != \"$word\" ] || return"
    print "    case \"$program $command\" in"
    for (i = 1; i <= count; i++)
        printf "    '%s') COMPREPLY=($(compgen -W '%s' -- \"$word\")) ;;\n", keys[i], substr(options[keys[i]], 2)
    print "    esac"
    print "}"
    print "complete -o default -F _terraclip terraclip planar-viewer planet-viewer"
}
