/* program.c - compiles and links shader programs from the files that are built into the program.
 *
 * A stage is one text: the #version line, the defines of the scene, then the parts in order. A #line directive before
 * each part numbers its lines from a multiple of 10,000, so that a compiler's complaint "0:20014(7): ..." (Mesa) or
 * "0(20014) : ..." (NVIDIA) can be told as "file.glsl:14: ...". (#line could number the part, too; Mesa ignores that.)
 */
#include "program.h"
#include "common/base/status.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The first part's lines start at PART_LINES; below it lie the defines. */
enum { PART_LINES = 10000, MAX_PARTS = 32, MAX_STRINGS = 2 + 2 * MAX_PARTS };

const char *tc_shader_text(const struct tc_shader_file *own, const char *name)
{
    for (const struct tc_shader_file *file = own; file && file->name; file++)
        if (strcmp(file->name, name) == 0)
            return file->text;
    for (const struct tc_shader_file *file = tc_shader_files; file->name; file++)
        if (strcmp(file->name, name) == 0)
            return file->text;
    return NULL;
}

/* Names of the parts as "a.glsl + b.vert", for complaints that say no place. */
static void join_names(const char *const *parts, char *names, size_t capacity)
{
    size_t used = 0;
    names[0] = '\0';
    for (int i = 0; parts[i] && used < capacity; i++)
        used += (size_t)snprintf(names + used, capacity - used, "%s%s", i ? " + " : "", parts[i]);
}

/* Where the log's first line starts with a place, reads its line and returns what follows; else NULL. */
static const char *read_place(const char *text, long *line)
{
    /* AMD and Intel of other systems begin with "ERROR: ". */
    if (strncmp(text, "ERROR: ", 7) == 0)
        text += 7;
    if (!isdigit((unsigned char)*text))
        return NULL;
    char *end;
    strtol(text, &end, 10); /* the string's number */
    if ((*end != ':' && *end != '(') || !isdigit((unsigned char)end[1]))
        return NULL;
    *line = strtol(end + 1, &end, 10);
    if (*end == '(') { /* Mesa's column */
        const char *close = strchr(end, ')');
        if (!close)
            return NULL;
        end += close - end;
    }
    return end + strspn(end, "): ");
}

/* Fails with the first line of the compiler's log that says something. */
static tc_status complain(tc_error *error, const char *const *parts, const char *log)
{
    log += strspn(log, "\r\n \t");
    char first[400];
    snprintf(first, sizeof first, "%.*s", (int)strcspn(log, "\r\n"), log);
    long line = 0;
    const char *what = read_place(first, &line);
    int count = 0;
    while (parts[count])
        count++;
    if (what && line >= PART_LINES && line / PART_LINES <= count)
        return tc_fail(error, TC_ERR_CONTEXT, "%s:%ld: %s", parts[line / PART_LINES - 1], line % PART_LINES, what);
    char names[200];
    join_names(parts, names, sizeof names);
    return tc_fail(error, TC_ERR_CONTEXT, "%s: %s", names, first[0] ? first : "not accepted, without a reason given");
}

/* Compiles one stage. */
static tc_status compile(const tc_gl *gl, GLenum type, const char *const *parts, const struct tc_shader_file *own,
                         const char *defines, GLuint *shader_ret, tc_error *error)
{
    const char *strings[MAX_STRINGS];
    char lines[MAX_PARTS][32];
    int count = 0;
    strings[count++] = "#version 450 core\n";
    strings[count++] = defines ? defines : "";
    for (int i = 0; parts[i]; i++) {
        const char *text = tc_shader_text(own, parts[i]);
        if (!text)
            return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: no such shader file in this program", parts[i]);
        if (i == MAX_PARTS)
            return tc_fail(error, TC_ERR_UNSUPPORTED, "%s: expected at most %d files in a stage", parts[i], MAX_PARTS);
        /* The line break first: defines need not end with one. */
        snprintf(lines[i], sizeof lines[i], "\n#line %d\n", PART_LINES * (i + 1) + 1);
        strings[count++] = lines[i];
        strings[count++] = text;
    }
    GLuint shader = gl->CreateShader(type);
    gl->ShaderSource(shader, count, strings, NULL);
    gl->CompileShader(shader);
    GLint compiled = GL_FALSE;
    gl->GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (!compiled) {
        char log[2048] = "";
        gl->GetShaderInfoLog(shader, sizeof log, NULL, log);
        gl->DeleteShader(shader);
        return complain(error, parts, log);
    }
    *shader_ret = shader;
    return TC_OK;
}

tc_status tc_program_build(const tc_gl *gl, const char *const *vertex, const char *const *fragment,
                           const struct tc_shader_file *own, const char *defines, GLuint *program_ret, tc_error *error)
{
    GLuint shaders[2] = {0, 0};
    tc_status status = compile(gl, GL_VERTEX_SHADER, vertex, own, defines, &shaders[0], error);
    if (status == TC_OK && fragment)
        status = compile(gl, GL_FRAGMENT_SHADER, fragment, own, defines, &shaders[1], error);
    if (status == TC_OK) {
        GLuint program = gl->CreateProgram();
        for (int i = 0; i < 2; i++)
            if (shaders[i])
                gl->AttachShader(program, shaders[i]);
        gl->LinkProgram(program);
        for (int i = 0; i < 2; i++)
            if (shaders[i])
                gl->DetachShader(program, shaders[i]);
        GLint linked = GL_FALSE;
        gl->GetProgramiv(program, GL_LINK_STATUS, &linked);
        if (linked) {
            *program_ret = program;
        } else {
            char log[2048] = "";
            gl->GetProgramInfoLog(program, sizeof log, NULL, log);
            gl->DeleteProgram(program);
            status = complain(error, vertex, log);
        }
    }
    for (int i = 0; i < 2; i++)
        if (shaders[i])
            gl->DeleteShader(shaders[i]);
    return status;
}
