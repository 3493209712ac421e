/*
 * patience: one table of the times after which something counts as late, hung or dead, and of the
 * beats that prove life meanwhile. All are in microseconds; names in _TIMES are factors.
 *
 * `fan -t SECONDS` states PATIENCE_SILENCE_US for its workers. "-t" below means that a longer
 * SECONDS replaces the time, because a user who waits longer for silence expects slower hosts.
 *
 * What is measured, such as a round trip, makes the time longer where it can: a constant alone must
 * be long enough for a loaded machine, so it is far above what an idle one needs.
 */
#ifndef STORMRING_PATIENCE_H
#define STORMRING_PATIENCE_H

/* ---- signs of life --------------------------------------------------------------------------- */

/* From one beat of a busy worker to the next: PATIENCE_SILENCE_US is more than six of them. */
#define PATIENCE_BEAT_US 450000
/* From one beat of a slot to the next that fan passes on: policies need no more. */
#define PATIENCE_BEAT_PASSED_US 250000

/* ---- a worker, seen by fan; a command, seen by a policy -------------------------------------- */

/* Silence of a slot that has work, or of a command that owes tasks. */
#define PATIENCE_SILENCE_US 3000000
/* The factor of this silence for each step of nice=: Linux gives a process of the next niceness so
 * much less of a processor that others want (Molnar, "CFS scheduler", sched-nice-design, 2007). */
#define PATIENCE_NICE_TIMES 1.25
/* Until hello, of a worker on this machine: it starts and tests itself in 10 ms when idle. -t */
#define PATIENCE_HELLO_US 10000000
/* Until hello, of another host: ssh has 10 s to connect. -t */
#define PATIENCE_REACH_US 15000000
/* Until hello, of a launcher that may queue (wait=): then the others begin without it. */
#define PATIENCE_QUEUED_US 5000000
/* While state is under way: a slow link delivers it in pieces. -t */
#define PATIENCE_LOADING_US 15000000
/* Until a worker here ends, when nothing is left to send. */
#define PATIENCE_CLOSING_US 1000000
/* Without any slot up, while there is work. */
#define PATIENCE_UNREACHED_US 30000000
/* Likewise, if every host was up before: a switch restarts in minutes. */
#define PATIENCE_RETURN_US 600000000
/* Before the first and, at most, before each further try to connect. It is doubled each time. */
#define PATIENCE_RETRY_FIRST_US 500000
#define PATIENCE_RETRY_MOST_US 10000000
/* A slot that fails within this time is measured once more (fan -l). */
#define PATIENCE_ASK_AGAIN_US 5000000
/* For the answer to a probe of a link: then the link counts as slow. */
#define PATIENCE_PROBE_US 3000000
/* A round of fan may begin this much late: beyond, fan itself was kept from running. */
#define PATIENCE_ROUND_US 100000

/* ---- a child, seen by a worker of several slots ---------------------------------------------- */

/* Most silence that counts in one round of the worker: beyond, the worker itself was late. The
 * child is lost after PATIENCE_SILENCE_US. */
#define PATIENCE_PARENT_US 200000

/* ---- fan, seen by a worker ------------------------------------------------------------------- */

/* Without a word from fan for this number of times PATIENCE_SILENCE_US or -t, the connection is
 * dead. */
#define PATIENCE_ALIVE_TIMES 10

/* ---- a process that was told to end ---------------------------------------------------------- */

/* Until SIGTERM, after `bye`: a worker looks for it every 100 ms. */
#define PATIENCE_BYE_US 800000
/* Until SIGKILL, after SIGTERM: a worker has nothing to tidy. */
#define PATIENCE_STOP_US 200000
/* Likewise, for a launcher: ssh passes the end on to another host, srun takes its job out of the
 * queue. */
#define PATIENCE_LAUNCHER_US 2000000
/* Until SIGKILL, after the end of its stream: it may still write its last words. */
#define PATIENCE_EXIT_US 500000

/* ---- a task or an answer, seen by a policy --------------------------------------------------- */

/* A task that a slot has had for long is late, and goes to another slot as well: after this number
 * of times that the other one would need for it, with a time added for a busy machine, and after a
 * day at most. */
#define PATIENCE_TASK_TIMES 4
#define PATIENCE_TASK_US 200000
#define PATIENCE_TASK_MOST_US 86400e6
/* An answer of a node of the ring is late after this number of times the longest answer so far,
 * with a time added; or after a fixed time while none has come. The factor is twice that of a task,
 * because asking another node instead gains little. */
#define PATIENCE_ANSWER_TIMES 8
#define PATIENCE_ANSWER_US 100000
#define PATIENCE_FIRST_ANSWER_US 3000000
/* The least timeout of the published ring. */
#define PATIENCE_PUBLISHED_US 500000

#endif
