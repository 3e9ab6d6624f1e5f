function [result, info] = measure(varargin)
% mbk.measure  Inertia, damping and stiffness of a limb, with intervals, ellipses and warnings.
%
%   RESULT = mbk.measure(...) is the document that 'mbk measure --json' writes, as a struct with every digit.
%   [RESULT, INFO] = mbk.measure(...) also gives INFO.text, that document itself, INFO.exit_code (0: fine,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.measure(FILE)                   the name of a file, or a cell of several
%   [...] = mbk.measure(T, X, F)                time in s, position in m (rad), force in N (N.m): columns, one axis
%                                           or two
%   [...] = mbk.measure(T, X, F, XR)            with the reference of the perturbation; then perhaps acceleration
%   [...] = mbk.measure(DATA)                   a struct of signals (time, x, Fx, ...), a 19 x N logs matrix, a table,
%                                           a timetable or iddata; units as the field units, or the table, says
%   [...] = mbk.measure(..., NAME, VALUE, ...)  options of 'mbk measure' on the command line, as in
%                                           'mode', 'reference', 'cutoff', 5; flags take true
%
%   Units are SI. RESULT.model has M, B, K and x0, RESULT.standard_error their standard errors; where the answer must
%   not be trusted, RESULT.usable is false and RESULT.warnings says why.
%
%   Example
%     result = mbk.measure('log.mat', 'mode', 'reference');
%     K = result.model.K
%     mbk.plot(result)
%
%   Errors are mbk:usage, mbk:data and mbk:not_usable; warnings are mbk:CODE, with _ for -.
%   See also mbk.identify, mbk.passivity, mbk.plot, mbk.read
  [result, info] = mbk.internal.run('measure', varargin);
end
