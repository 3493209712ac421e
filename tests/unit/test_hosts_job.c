/* The hosts of a job: what Slurm and PBS say of it, and what is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "hosts/hosts.h"

#include <string.h>
#include <unistd.h>

static char err[HOSTS_ERR];
static struct hosts hosts;

static bool slurm(const char *nodes, const char *cpus)
{
    setenv("SLURM_JOB_NODELIST", nodes, 1);
    setenv("SLURM_JOB_CPUS_PER_NODE", cpus, 1);
    return hosts_read(&hosts, "slurm:", err);
}

/* The job has these hosts, as `NAME/SLOTS ` each. */
static void has(const char *expected)
{
    struct buf text = {0};
    int slots = 0;
    for (size_t i = 0; i < hosts.n; i++) {
        buf_printf(&text, "%s/%d ", hosts.at[i].name, hosts.at[i].slots);
        slots += hosts.at[i].slots;
    }
    buf_append(&text, "", 1);
    assert_string_equal((char *)text.data, expected);
    assert_int_equal(hosts.slots, slots);
    buf_free(&text);
    hosts_free(&hosts);
}

/* The message begins with `place` and has these words, and there is no table. */
static void said(const char *place, const char *words)
{
    assert_int_equal(strncmp(err, place, strlen(place)), 0);
    assert_non_null(strstr(err, words));
    assert_non_null(strstr(err, "expected"));
    assert_null(hosts.at);
}

static void brackets_stand_for_nodes(void **state)
{
    (void)state;
    static const char *const rows[][3] = {
        {"n1", "4", "n1/4 "},
        {"n[1-3]", "2(x3)", "n1/2 n2/2 n3/2 "},
        {"n[8-11]", "1(x4)", "n8/1 n9/1 n10/1 n11/1 "},
        {"n[08-11]", "1(x4)", "n08/1 n09/1 n10/1 n11/1 "},
        {"n[0-1,7,10]", "1(x4)", "n0/1 n1/1 n7/1 n10/1 "},
        {"n[000,002]", "1(x2)", "n000/1 n002/1 "},
        {"b,a[1-250],c.d-e_f", "3,4000(x250),4096", NULL},
        {"b,a[1-2],c.d-e_f", "3,1(x2),4000", "b/3 a1/1 a2/1 c.d-e_f/4000 "},
        {"r[1-2]n[1-2]-ib,x", "1,2,3,4,5", "r1n1-ib/1 r1n2-ib/2 r2n1-ib/3 r2n2-ib/4 x/5 "},
        {"[1-2]", "1(x1),1(x1)", "1/1 2/1 "},
        {"n[999999999999999999]", "1", "n999999999999999999/1 "},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_int_equal(slurm(rows[i][0], rows[i][1]), rows[i][2] != NULL);
        if (rows[i][2]) has(rows[i][2]);
        else said("SLURM_JOB_CPUS_PER_NODE: ", "1000003 slots");
    }
    assert_true(slurm("n[1-100]", "128(x100)"));
    assert_int_equal(hosts.slots, 12800);
    hosts_free(&hosts);
    assert_true(slurm("n[000001-100000]", "10(x100000)"));
    assert_int_equal(hosts.slots, HOSTS_SLOTS_MAX);
    assert_string_equal(hosts.at[99999].name, "n100000");
    hosts_free(&hosts);
}

/* A name as long as a name may be, in both parts around a number; and one byte more. */
static void names_have_a_limit(void **state)
{
    (void)state;
    char nodes[HOST_NAME_MOST + 8];
    for (int more = 0; more <= 1; more++) {
        memset(nodes, 'n', sizeof nodes);
        memcpy(nodes, "a[1]", 4);
        nodes[HOST_NAME_MOST + 2 + more] = '\0';
        assert_int_equal(slurm(nodes, "1"), !more);
        if (!more) assert_int_equal(strlen(hosts.at[0].name), HOST_NAME_MOST);
        else said("SLURM_JOB_NODELIST: 'nnn", "255");
        if (!more) hosts_free(&hosts);
        memset(nodes, 'n', sizeof nodes);
        memcpy(nodes + HOST_NAME_MOST - 1 + more, "[1]", 4);
        assert_int_equal(slurm(nodes, "1"), !more);
        if (!more) hosts_free(&hosts);
        else said("SLURM_JOB_NODELIST: 'nnn", "255");
    }
}

static void other_lists_of_nodes_are_refused(void **state)
{
    (void)state;
    static const char *const rows[][2] = {
        {"", "empty"},
        {",", "name"},
        {"n1,", "name"},
        {",n1", "name"},
        {"n1,,n2", "name"},
        {"n[1-2", "] after ["},
        {"n[", "] after ["},
        {"n1]", "name"},
        {"n]1", "name"},
        {"n[[1-2]]", "'[1-2': "},
        {"n[]", "LOW-HIGH"},
        {"n[,1]", "LOW-HIGH"},
        {"n[1,]", "LOW-HIGH"},
        {"n[3-1]", "'3-1': "},
        {"n[1-]", "'1-': "},
        {"n[-1]", "'-1': "},
        {"n[1-2-3]", "LOW-HIGH"},
        {"n[01-2]", "LOW-HIGH"},
        {"n[1-02]", "LOW-HIGH"},
        {"n[01-100]", "LOW-HIGH"},
        {"n[a-c]", "LOW-HIGH"},
        {"n[1.5]", "LOW-HIGH"},
        {"n[+1]", "LOW-HIGH"},
        {"n[ 1]", "LOW-HIGH"},
        {"n[0x1]", "LOW-HIGH"},
        {"n[1234567890123456789]", "LOW-HIGH"},
        {"n[0-999999999999999999]", "at most 100000"},
        {"n[1-100001]", "at most 100000"},
        {"a[1-4000],b[1-96001]", "at most 100000"},
        {"n[1111111111111111111111111111111111111111111111111111111111111111111]", "LOW-HIGH"},
        {"n1,n1", "'n1': expected each node once"},
        {"n[1-2],n2", "each node once"},
        {"n[1,1]", "each node once"},
        {"-oProxyCommand=x", "name"},
        {"-[1]", "name"},
        {"n1 n2", "name"},
        {":", "name"},
        {"me@n1", "name"},
        {"a;b", "name"},
        {"n$(x)", "name"},
        {"n1\n", "name"},
        {"../n", "name"},
        {"\xc3\xa4", "name"},
        {"n%h", "name"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_false(slurm(rows[i][0], "1(x2)"));
        said("SLURM_JOB_NODELIST: ", rows[i][1]);
    }
    unsetenv("SLURM_JOB_NODELIST");
    assert_false(hosts_read(&hosts, "slurm:", err));
    said("SLURM_JOB_NODELIST: ", "not set");
}

static void other_counts_of_processors_are_refused(void **state)
{
    (void)state;
    static const char *const rows[][2] = {
        {"", "empty"},
        {",", "''"},
        {"2(x4),", "''"},
        {"2,2,2", "fewer nodes, expected 4, as in"},
        {"2(x3)", "fewer"},
        {"2(x5)", "more nodes, expected 4"},
        {"2,2,2,2,2", "more"},
        {"2(x2),2(x3)", "more"},
        {"0(x4)", "processors"},
        {"2(x0)", "processors"},
        {"2(x-1)", "processors"},
        {"-2(x4)", "processors"},
        {"4097(x4)", "processors"},
        {"2(x100001)", "processors"},
        {"2(x4", "processors"},
        {"2(x44", "processors"},
        {"2x4", "processors"},
        {"2(4)", "processors"},
        {"(x4)", "processors"},
        {"2(x)", "processors"},
        {"2(x4)1", "processors"},
        {"2 (x4)", "processors"},
        {"2(x4) ", "processors"},
        {"2(x2)(x2)", "processors"},
        {"2.5(x4)", "processors"},
        {"0x2(x4)", "processors"},
        {"99999999999999999999", "processors"},
        {"two", "processors"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_false(slurm("n[1-4]", rows[i][0]));
        said("SLURM_JOB_CPUS_PER_NODE: ", rows[i][1]);
    }
    unsetenv("SLURM_JOB_CPUS_PER_NODE");
    assert_false(hosts_read(&hosts, "slurm:", err));
    said("SLURM_JOB_CPUS_PER_NODE: ", "not set");
}

static void a_node_is_reached_by_a_step_of_its_own(void **state)
{
    (void)state;
    char word[] = "rtworker", option[] = "it's";
    char *worker[] = {word, option, NULL};
    assert_true(slurm("n[1-2]", "4,16"));
    char **argv = host_argv(&hosts.at[1], worker);
    assert_string_equal(argv[2], "exec srun -Qu -N 1 -n 1 -c 16 --overlap -w n2 sh -c"
                                 " 'exec rtworker '\\''it'\\''\\'\\'''\\''s'\\'''");
    host_argv_free(argv);
    hosts_free(&hosts);
}

/* Each part has its own variables; the first one may have those of the job. */
static void parts_of_a_heterogeneous_job_have_their_own_steps(void **state)
{
    (void)state;
    char word[] = "rtworker", *worker[] = {word, NULL};
    setenv("SLURM_HET_SIZE", "2", 1);
    setenv("SLURM_JOB_NODELIST_HET_GROUP_1", "n[1-3]", 1);
    setenv("SLURM_JOB_CPUS_PER_NODE_HET_GROUP_1", "64(x3)", 1);
    assert_true(slurm("n1", "2"));
    char **argv = host_argv(&hosts.at[3], worker);
    assert_string_equal(argv[2],
        "exec srun -Qu --het-group=1 -N 1 -n 1 -c 64 --overlap -w n3 sh -c 'exec rtworker'");
    host_argv_free(argv);
    has("n1/2 n1/64 n2/64 n3/64 ");
    setenv("SLURM_JOB_NODELIST_HET_GROUP_0", "n[8-9]", 1);
    setenv("SLURM_JOB_CPUS_PER_NODE_HET_GROUP_0", "1(x2)", 1);
    assert_true(slurm("n1", "2"));
    has("n8/1 n9/1 n1/64 n2/64 n3/64 ");
    setenv("SLURM_JOB_CPUS_PER_NODE_HET_GROUP_1", "64(x2)", 1);
    assert_false(slurm("n1", "2"));
    said("SLURM_JOB_CPUS_PER_NODE_HET_GROUP_1: fewer nodes, expected 3, as in "
         "SLURM_JOB_NODELIST_HET_GROUP_1",
        "fewer");
    setenv("SLURM_HET_SIZE", "3", 1);
    setenv("SLURM_JOB_CPUS_PER_NODE_HET_GROUP_1", "64(x3)", 1);
    assert_false(slurm("n1", "2"));
    said("SLURM_JOB_NODELIST_HET_GROUP_2: ", "not set");
    setenv("SLURM_HET_SIZE", "many", 1);
    assert_false(slurm("n1", "2"));
    said("SLURM_HET_SIZE: 'many'", "parts");
    unsetenv("SLURM_HET_SIZE");
    assert_true(slurm("n1", "2"));
    has("n1/2 ");
}

/* ---- PBS ---- */

static char path[32];

static bool pbs(const char *text, size_t n)
{
    memcpy(path, "/tmp/nodes.XXXXXX", 18);
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_int_equal(write_full(fd, text, n), 0);
    close(fd);
    setenv("PBS_NODEFILE", path, 1);
    bool good = hosts_read(&hosts, "pbs:", err);
    unlink(path);
    return good;
}

static void a_node_has_a_slot_for_each_line(void **state)
{
    (void)state;
    static const char same[] = "n1\nn2.example.org\nn1\nn3\nn2.example.org\nn1\n";
    assert_true(pbs(same, sizeof same - 1));
    assert_null(hosts.at[0].via);
    has("n1/3 n2.example.org/2 n3/1 ");
    assert_true(pbs("n1", 2));
    has("n1/1 ");
}

static void other_files_of_nodes_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        int line;
        const char *words;
    } rows[] = {
        {"n1\n\nn2\n", 2, "name"},
        {"n1 slots=2\n", 1, "name"},
        {"n1\r\n", 1, "name"},
        {"n1\nn2 \n", 2, "name"},
        {"# nodes\n", 1, "name"},
        {"n[1-2]\n", 1, "name"},
        {"n1\nn1\n-oProxyCommand=x\n", 3, "name"},
        {":\n", 1, "name"},
        {"me@n1\n", 1, "name"},
        {"a;b\n", 1, "name"},
        {"\n", 1, "name"},
    };
    char place[64];
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_false(pbs(rows[i].text, strlen(rows[i].text)));
        snprintf(place, sizeof place, "%s:%d: ", path, rows[i].line);
        said(place, rows[i].words);
    }
    assert_false(pbs("n1\nn\0002\n", 7));
    said(path, "name");
    assert_false(pbs("", 0));
    said(path, "empty");
    static char many[2 * (HOST_SLOTS_MAX + 1)];
    for (size_t i = 0; i < sizeof many; i += 2) memcpy(many + i, "n\n", 2);
    assert_true(pbs(many, sizeof many - 2));
    has("n/4096 ");
    assert_false(pbs(many, sizeof many));
    snprintf(place, sizeof place, "%s:4097: ", path);
    said(place, "at most 4096");
}

static void a_file_of_nodes_must_be_a_file(void **state)
{
    (void)state;
    static const char *const rows[][3] = {
        {"", "PBS_NODEFILE: ", "empty"},
        {"/no/such/file", "/no/such/file: ", "No such file"},
        {"/dev/zero", "/dev/zero: ", "regular file"},
        {"/tmp", "/tmp: ", "regular file"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        setenv("PBS_NODEFILE", rows[i][0], 1);
        assert_false(hosts_read(&hosts, "pbs:", err));
        said(rows[i][1], rows[i][2]);
    }
    unsetenv("PBS_NODEFILE");
    assert_false(hosts_read(&hosts, "pbs:", err));
    said("PBS_NODEFILE: ", "not set");
}

/* The two words stand alone. */
static void a_job_is_no_entry_of_a_list(void **state)
{
    (void)state;
    static const char *const lists[] = {"slurm:,n1", "n1,pbs:", "4/slurm:", "slurm:n1", "pbs:/x"};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        assert_false(hosts_read(&hosts, lists[i], err));
        said("-S: ", "");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(brackets_stand_for_nodes),
        cmocka_unit_test(names_have_a_limit),
        cmocka_unit_test(other_lists_of_nodes_are_refused),
        cmocka_unit_test(other_counts_of_processors_are_refused),
        cmocka_unit_test(a_node_is_reached_by_a_step_of_its_own),
        cmocka_unit_test(parts_of_a_heterogeneous_job_have_their_own_steps),
        cmocka_unit_test(a_node_has_a_slot_for_each_line),
        cmocka_unit_test(other_files_of_nodes_are_refused),
        cmocka_unit_test(a_file_of_nodes_must_be_a_file),
        cmocka_unit_test(a_job_is_no_entry_of_a_list),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
