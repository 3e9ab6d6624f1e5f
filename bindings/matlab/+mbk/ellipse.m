function [result, info] = ellipse(varargin)
% mbk.ellipse  Ellipses of a result.
%
%   RESULT = mbk.ellipse(...) is the document that 'mbk ellipse --json' writes, as a struct with every digit.
%   [RESULT, INFO] = mbk.ellipse(...) also gives INFO.text, that document itself, INFO.exit_code (0: fine,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.ellipse(INFO)      the second output of mbk.measure
%   [...] = mbk.ellipse('r.json')  a file
%
%   Errors are mbk:usage, mbk:data and mbk:not_usable; warnings are mbk:CODE, with _ for -.
%   See also mbk.measure
  [result, info] = mbk.internal.run('ellipse', varargin);
end
