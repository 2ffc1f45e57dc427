/* network.h - the addresses of this site; hal/ethernet/network.c has them. */
#ifndef HAL_NETWORK_H
#define HAL_NETWORK_H

#include "hal/ethernet/net.h"

extern const struct net_config network;

#endif
