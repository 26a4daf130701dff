# paper.awk - rows of papers.csv that are called SUBJECT: QUANTITY, by both. After of_paper() of each row,
#     paper_subjects, paper_subject[i]   in their order
#     paper_value[SUBJECT, QUANTITY]     as it stands there
# papers: the file's name; the paper and its table are named by paper and table.
function of_paper(f,    at_colon, subject) {
    if (f[1] != paper || f[2] != table || !match(f[3], /: [^:]*$/))
        return
    at_colon = RSTART
    subject = substr(f[3], 1, at_colon - 1)
    if (!(subject in paper_known)) {
        paper_known[subject] = 1
        paper_subject[++paper_subjects] = subject
    }
    paper_value[subject, substr(f[3], at_colon + 2)] = f[4]
}

function as_field(text) {
    gsub(/"/, "\"\"", text)
    return "\"" text "\""
}
