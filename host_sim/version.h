/* version.h - the version of the program and the library; contactplant.h and its test repeat it. */
#ifndef HOST_SIM_VERSION_H
#define HOST_SIM_VERSION_H

#define VERSION_TEXT "0.9.0"

#endif
