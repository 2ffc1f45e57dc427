# hash_compare.awk - lines of tests/bits/hash_print.c or tests/boards/board_hash.c against tests/data/hash.txt.
#   awk -v blocks=100 [-v unwanted=REGEX] -f tests/bits/hash_compare.awk tests/data/hash.txt GOT
# Every golden name that does not match `unwanted` must be there, with at least `blocks` hashes (a shorter golden
# line: its own number). Prints one text: how much is the same, or the first block of the first trajectory that differs; exit status 0, 1.
FNR == NR {
    golden[$1] = $0
    name[n_golden++] = $1
    next
}
{
    got[$1] = $0
    if (!($1 in golden))
        fail($1 " is not in " ARGV[1])
}
END {
    for (k = 0; k < n_golden; k++)
        if (unwanted == "" || name[k] !~ unwanted)
            compare(name[k])
    if (!bad)
        printf "%d trajectories, %d blocks, all the same\n", n_names, n_blocks
    else
        print bad (n_bad > 1 ? ", and " n_bad - 1 " more" : "")
    exit n_bad > 0
}
function fail(text) {
    n_bad++
    if (!bad)
        bad = text
}
function compare(which,    want, have, n, i) {
    n = split(golden[which], want)
    if (n > blocks + 1)
        n = blocks + 1
    split(got[which], have)
    for (i = 2; i <= n; i++)
        if (want[i] != have[i]) {
            if (have[i] == "stopped:")
                have[i] = substr(got[which], index(got[which], "stopped:"))
            fail(sprintf("%s differs in block %d, ticks %d to %d: golden %s, here %s", which, i - 1, 1000 * (i - 2),
                1000 * (i - 1), want[i], have[i] == "" ? "nothing" : have[i]))
            return
        }
    n_names++
    n_blocks += n - 1
}
