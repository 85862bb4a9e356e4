/* A runtime for OpenXR's loader that has no device: it hands haptic calls to the functions judged_apply and judged_stop of the program that the loader
 * is in, which exports them, and makes handles for the rest of what a program needs on its way there. */
#define _POSIX_C_SOURCE 200809L
#include <openxr/openxr.h>
#include <stdint.h>
#include <string.h>

XrResult XRAPI_CALL judged_apply(XrSession, const XrHapticActionInfo *, const XrHapticBaseHeader *);
XrResult XRAPI_CALL judged_stop(XrSession, const XrHapticActionInfo *);
uint64_t judged_session(void);

/* As the loader declares them in its sources. */
typedef struct {
    uint32_t type, version;
    size_t size;
    uint32_t least_interface, most_interface;
    XrVersion least_api, most_api;
} Loader;
typedef struct {
    uint32_t type, version;
    size_t size;
    uint32_t interface;
    XrVersion api;
    PFN_xrGetInstanceProcAddr find;
} Runtime;

static XrResult XRAPI_CALL extensions(const char *layer, uint32_t room, uint32_t *count, XrExtensionProperties *told) {
    static const char *names[] = {"XR_MND_headless", "XR_EXT_debug_utils", "XR_FB_haptic_amplitude_envelope", "XR_FB_haptic_pcm", "XR_EXT_haptic_parametric"};
    (void)layer;
    *count = 5;
    for (uint32_t at = 0; at < 5 && room > 0; at++) {
        strcpy(told[at].extensionName, names[at]);
        told[at].extensionVersion = 1;
    }
    return XR_SUCCESS;
}

static XrResult XRAPI_CALL create_instance(const XrInstanceCreateInfo *info, XrInstance *instance) {
    (void)info;
    *instance = (XrInstance)(uintptr_t)1;
    return XR_SUCCESS;
}

static XrResult XRAPI_CALL properties(XrInstance instance, XrInstanceProperties *told) {
    (void)instance;
    told->runtimeVersion = 1;
    strcpy(told->runtimeName, "no device");
    return XR_SUCCESS;
}

static XrResult XRAPI_CALL system_of(XrInstance instance, const XrSystemGetInfo *info, XrSystemId *id) {
    (void)instance, (void)info;
    *id = 1;
    return XR_SUCCESS;
}

static XrResult XRAPI_CALL create_session(XrInstance instance, const XrSessionCreateInfo *info, XrSession *session) {
    (void)instance, (void)info;
    *session = (XrSession)(uintptr_t)judged_session();
    return XR_SUCCESS;
}

static XrResult XRAPI_CALL create_action_set(XrInstance instance, const XrActionSetCreateInfo *info, XrActionSet *set) {
    (void)instance, (void)info;
    *set = (XrActionSet)(uintptr_t)5;
    return XR_SUCCESS;
}

static XrResult XRAPI_CALL create_action(XrActionSet set, const XrActionCreateInfo *info, XrAction *action) {
    (void)set, (void)info;
    *action = (XrAction)(uintptr_t)7;
    return XR_SUCCESS;
}

static XrResult XRAPI_CALL to_path(XrInstance instance, const char *text, XrPath *path) {
    (void)instance, (void)text;
    *path = 1;
    return XR_SUCCESS;
}

static XrResult XRAPI_CALL destroy_instance(XrInstance instance) { return instance ? XR_SUCCESS : XR_ERROR_HANDLE_INVALID; }
static XrResult XRAPI_CALL destroy_session(XrSession session) { return session ? XR_SUCCESS : XR_ERROR_HANDLE_INVALID; }
static XrResult XRAPI_CALL no_event(XrInstance instance, XrEventDataBuffer *event) {
    (void)instance, (void)event;
    return XR_EVENT_UNAVAILABLE;
}

static XrResult XRAPI_CALL find(XrInstance instance, const char *name, PFN_xrVoidFunction *function) {
    static const struct {
        const char *name;
        PFN_xrVoidFunction function;
    } known[] = {
        {"xrGetInstanceProcAddr", (PFN_xrVoidFunction)find},
        {"xrEnumerateInstanceExtensionProperties", (PFN_xrVoidFunction)extensions},
        {"xrCreateInstance", (PFN_xrVoidFunction)create_instance},
        {"xrDestroyInstance", (PFN_xrVoidFunction)destroy_instance},
        {"xrGetInstanceProperties", (PFN_xrVoidFunction)properties},
        {"xrPollEvent", (PFN_xrVoidFunction)no_event},
        {"xrGetSystem", (PFN_xrVoidFunction)system_of},
        {"xrCreateSession", (PFN_xrVoidFunction)create_session},
        {"xrDestroySession", (PFN_xrVoidFunction)destroy_session},
        {"xrCreateActionSet", (PFN_xrVoidFunction)create_action_set},
        {"xrCreateAction", (PFN_xrVoidFunction)create_action},
        {"xrStringToPath", (PFN_xrVoidFunction)to_path},
        {"xrApplyHapticFeedback", (PFN_xrVoidFunction)judged_apply},
        {"xrStopHapticFeedback", (PFN_xrVoidFunction)judged_stop},
    };
    (void)instance;
    for (size_t at = 0; at < sizeof known / sizeof *known; at++) {
        if (strcmp(known[at].name, name) == 0) {
            *function = known[at].function;
            return XR_SUCCESS;
        }
    }
    *function = NULL;
    return XR_ERROR_FUNCTION_UNSUPPORTED;
}

__attribute__((visibility("default"))) XrResult XRAPI_CALL xrNegotiateLoaderRuntimeInterface(const Loader *loader, Runtime *runtime) {
    if (loader->least_interface > 1 || loader->most_interface < 1)
        return XR_ERROR_INITIALIZATION_FAILED;
    runtime->interface = 1, runtime->api = XR_MAKE_VERSION(1, 0, 20), runtime->find = find;
    return XR_SUCCESS;
}
