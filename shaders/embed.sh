#!/bin/sh
# Prints C source that holds the named shader files as strings: tc_shader_files[] of {name, text}, ended by NULL.
echo '/* made by shaders/embed.sh */'
echo '#include "common/gl/program.h"'
echo 'const struct tc_shader_file tc_shader_files[] = {'
for f; do
    printf '{"%s",\n' "${f##*/}"
    sed -e 's/\\/\\\\/g' -e 's/"/\\"/g' -e 's/^/"/' -e 's/$/\\n"/' "$f"
    echo '},'
done
echo '{0, 0}};'
