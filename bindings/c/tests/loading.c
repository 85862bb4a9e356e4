#define _GNU_SOURCE
/* loading LIBRARY COPY: the library loaded at run time as plug-ins are, closed while it plays, loaded twice from two files, and in a process
 * that has forked. Nothing crashes or hangs, and a handle of one copy is none of the other. */
#include "common.h"

#include <dlfcn.h>
#include <pthread.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* The calls that are made through one loaded copy. */
typedef struct {
    void *library;
    int32_t (*build)(const asp_config *, asp_scene **, asp_renderer **);
    int32_t (*add_body)(asp_scene *, const asp_body *, uint64_t *);
    int32_t (*report)(asp_scene *, double, const asp_event *, uint32_t, uint32_t, uint32_t *);
    int32_t (*open_port)(asp_scene *, const asp_port_config *, asp_port **);
    void (*render)(asp_renderer *, float *, uint32_t, uint32_t, const int32_t *);
    int32_t (*play)(asp_renderer *, const asp_player_config *, asp_player **);
    int32_t (*stop)(asp_player *, asp_player_report *);
    int32_t (*reset)(asp_scene *);
    int32_t (*scene_free)(asp_scene *);
    int32_t (*renderer_free)(asp_renderer *);
    int32_t (*port_free)(asp_port *);
    const char *(*last_error)(void);
} copy;

static void found(void *library, const char *name, void *to) {
    void *symbol = dlsym(library, name);
    MUST(symbol);
    memcpy(to, &symbol, sizeof symbol);
}

static copy load(const char *path) {
    copy c;
    c.library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!c.library) {
        fprintf(stderr, "%s\n", dlerror());
        exit(1);
    }
    found(c.library, "asp_build", &c.build), found(c.library, "asp_add_body", &c.add_body);
    found(c.library, "asp_report", &c.report), found(c.library, "asp_open_port", &c.open_port);
    found(c.library, "asp_render_interleaved", &c.render), found(c.library, "asp_play", &c.play);
    found(c.library, "asp_player_stop", &c.stop), found(c.library, "asp_reset", &c.reset);
    found(c.library, "asp_scene_free", &c.scene_free), found(c.library, "asp_renderer_free", &c.renderer_free);
    found(c.library, "asp_port_free", &c.port_free), found(c.library, "asp_last_error", &c.last_error);
    return c;
}

static void rest(int milliseconds) {
    struct timespec wait = {0, milliseconds * 1000000L};
    nanosleep(&wait, NULL);
}

static void build(copy *c, const char *more, asp_scene **scene, asp_renderer **renderer) {
    asp_config config;
    asp_config_init(&config);
    config.clock = ASP_CLOCK_EXACT, config.more = more;
    MUST(c->build(&config, scene, renderer) == ASP_OK);
}

static uint64_t bell(copy *c, asp_scene *scene) {
    asp_body body;
    asp_body_init(&body);
    body.stock = "bar", body.size_m = 0.2;
    uint64_t id = 0;
    MUST(c->add_body(scene, &body, &id) == ASP_OK);
    return id;
}

static float struck(copy *c, asp_scene *scene, asp_renderer *renderer, uint64_t body) {
    asp_event strike = asp_impact(body, 1, 0.01, 0.005);
    MUST(c->report(scene, 0.1, &strike, 1, sizeof strike, NULL) == ASP_OK);
    float out[2 * 512], peak = 0;
    for (int i = 0; i < 20; i++) {
        c->render(renderer, out, 2, 512, NULL);
        for (int s = 0; s < 2 * 512; s++)
            peak = out[s] > peak ? out[s] : peak;
    }
    return peak;
}

/* The number of a handle of one copy means nothing to another. */
static void two_copies(copy *a, copy *b) {
    MUST(a->library != b->library);
    asp_scene *scene[2];
    asp_renderer *renderer[2];
    asp_port *port;
    build(a, NULL, &scene[0], &renderer[0]), build(b, NULL, &scene[1], &renderer[1]);
    asp_port_config wanted;
    asp_port_config_init(&wanted);
    MUST(a->open_port(scene[0], &wanted, &port) == ASP_OK);
    MUST(b->reset(scene[0]) == ASP_BAD_HANDLE && a->reset(scene[1]) == ASP_BAD_HANDLE);
    MUST(strstr(a->last_error(), "no handle of this kind"));
    MUST(b->scene_free(scene[0]) == ASP_BAD_HANDLE && b->renderer_free(renderer[0]) == ASP_BAD_HANDLE);
    MUST(b->port_free(port) == ASP_BAD_HANDLE);
    MUST(struck(a, scene[0], renderer[0], bell(a, scene[0])) > 0 && struck(b, scene[1], renderer[1], bell(b, scene[1])) > 0);
    MUST(a->port_free(port) == ASP_OK);
    MUST(a->scene_free(scene[0]) == ASP_OK && a->renderer_free(renderer[0]) == ASP_OK);
    MUST(b->scene_free(scene[1]) == ASP_OK && b->renderer_free(renderer[1]) == ASP_OK);
}

static asp_player *play(copy *c, asp_scene **scene) {
    asp_renderer *renderer;
    asp_player_config config;
    asp_player *player;
    build(c, NULL, scene, &renderer);
    asp_player_config_init(&config);
    config.silent = 1;
    MUST(c->play(renderer, &config, &player) == ASP_OK);
    return player;
}

/* A thread that has an error's text of its own when the library is closed. */
static pthread_barrier_t closed;
static void *asks(void *library) {
    copy *c = (copy *)library;
    MUST(c->reset(NULL) == ASP_BAD_HANDLE && c->last_error()[0]);
    pthread_barrier_wait(&closed);
    pthread_barrier_wait(&closed);
    return NULL;
}

/* Closed while a thread of its own plays and others have texts: it stays where it is, and the handles mean the same when it is loaded again. */
static void closed_while_it_plays(const char *path) {
    copy c = load(path);
    asp_scene *scene;
    asp_player *player = play(&c, &scene);
    pthread_t thread;
    pthread_barrier_init(&closed, NULL, 2);
    MUST(pthread_create(&thread, NULL, asks, &c) == 0);
    pthread_barrier_wait(&closed);
    dlclose(c.library);
    rest(50);
    pthread_barrier_wait(&closed);
    MUST(pthread_join(thread, NULL) == 0);
    copy again = load(path);
    asp_player_report report;
    asp_player_report_init(&report);
    MUST(again.stop(player, &report) == ASP_OK && report.callbacks > 0);
    MUST(again.scene_free(scene) == ASP_OK);
    dlclose(again.library);
}

/* Engines of the parent go on sounding in a child; threads do not come along, and what waits for them says so. */
static void forked(copy *c) {
    for (int threads = 1; threads <= 3; threads++) {
        char more[32];
        snprintf(more, sizeof more, "threads = %d", threads);
        asp_scene *scene, *other;
        asp_renderer *renderer;
        build(c, more, &scene, &renderer);
        uint64_t body = bell(c, scene);
        asp_player *player = play(c, &other);
        MUST(struck(c, scene, renderer, body) > 0);
        rest(20);
        FILE *said = tmpfile();
        MUST(said);
        pid_t child = fork();
        MUST(child >= 0);
        if (child == 0) {
            MUST(dup2(fileno(said), 2) == 2);
            alarm(20);
            MUST(struck(c, scene, renderer, body) > 0);
            MUST(c->scene_free(scene) == ASP_OK && c->renderer_free(renderer) == ASP_OK && c->scene_free(other) == ASP_OK);
            int32_t status = c->stop(player, NULL);
            if (status != ASP_OK)
                MUST(strstr(c->last_error(), "process"));
            asp_scene *own;
            player = play(c, &own);
            rest(20);
            MUST(c->stop(player, NULL) == ASP_OK && c->scene_free(own) == ASP_OK);
            _exit(0);
        }
        int status;
        MUST(waitpid(child, &status, 0) == child);
        /* Panics that were caught count too. */
        rewind(said);
        char line[512];
        int silent = 1;
        for (; fgets(line, sizeof line, said); silent = 0)
            fputs(line, stderr);
        fclose(said);
        if (!silent || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
            fprintf(stderr, "%d threads: a child of fork ended with %x\n", threads, (unsigned)status);
            exit(1);
        }
        MUST(struck(c, scene, renderer, body) > 0 && c->stop(player, NULL) == ASP_OK);
        MUST(c->scene_free(other) == ASP_OK && c->scene_free(scene) == ASP_OK && c->renderer_free(renderer) == ASP_OK);
    }
}

int main(int count, char **words) {
    MUST(count == 3);
    closed_while_it_plays(words[1]);
    copy a = load(words[1]), b = load(words[2]);
    two_copies(&a, &b);
    forked(&a);
    printf("loading: two copies, closed while it plays, forked: nothing crashed or hung\n");
    return 0;
}
